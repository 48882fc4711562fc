#include "base/temporary.hpp"

#include <pthread.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "base/text.hpp"

namespace bodesmith {
namespace {

/// Fixed storage: a signal's handler may not allocate.
constexpr std::size_t kSlots = 256;
constexpr std::size_t kLongestPath = 4096;
struct Slot {
  enum State { free, taken, set };  ///< `set` when the path stands
  std::atomic<int> state{free};
  std::array<char, kLongestPath> path{};
};
std::array<Slot, kSlots> slots;
std::array<std::atomic<pid_t>, 64> children;
std::atomic<bool> ending{false};
std::atomic<int> held{0};
constexpr std::array kEndings = {SIGTERM, SIGHUP, SIGQUIT, SIGINT, SIGALRM};

void on_ending(int signal) {
  end_at_once(128 + signal);
}

}  // namespace

void remember_temporary(const std::filesystem::path& path) {
  const std::string text = path.string();
  if (text.size() >= kLongestPath) return;
  for (Slot& slot : slots) {
    int expected = Slot::free;
    if (!slot.state.compare_exchange_strong(expected, Slot::taken)) continue;
    std::memcpy(slot.path.data(), text.c_str(), text.size() + 1);
    slot.state.store(Slot::set);
    return;
  }
}

void forget_temporary(const std::filesystem::path& path) {
  for (Slot& slot : slots) {
    int expected = Slot::set;
    if (slot.state.load() != Slot::set || path.string() != slot.path.data()) continue;
    if (slot.state.compare_exchange_strong(expected, Slot::free)) return;
  }
}

void remember_child(pid_t child) {
  for (auto& place : children) {
    pid_t none = 0;
    if (place.compare_exchange_strong(none, child)) return;
  }
}

void forget_child(pid_t child) {
  for (auto& place : children) {
    pid_t it = child;
    if (place.compare_exchange_strong(it, 0)) return;
  }
}

EndingHeld::EndingHeld() {
  sigset_t endings;
  sigemptyset(&endings);
  for (const int signal : kEndings) sigaddset(&endings, signal);
  ::pthread_sigmask(SIG_BLOCK, &endings, &before_);
  ++held;
  if (!ending.load()) return;
  --held;
  for (;;) ::pause();
}

EndingHeld::~EndingHeld() {
  --held;
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void EndingHeld::forget_in_child() const {
  for (const int signal : kEndings) std::signal(signal, SIG_DFL);
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void end_at_once(int status) {
  ending.store(true);
  // A disk that hangs does not keep the program: two seconds.
  constexpr timespec kMillisecond = {0, 1'000'000};
  for (int waited = 0; held.load() > 0 && waited < 2000; ++waited) ::nanosleep(&kMillisecond, nullptr);
  for (const auto& child : children) {
    const pid_t process = child.load();
    if (process <= 0) continue;
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);  // until then it may still make files
  }
  for (const Slot& slot : slots) {
    if (slot.state.load() == Slot::set) ::unlink(slot.path.data());
  }
  for (const Slot& slot : slots) {
    if (slot.state.load() == Slot::set) ::rmdir(slot.path.data());
  }
  ::_exit(status);
}

void catch_endings() {
  for (const int signal : {SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, on_ending);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool is_running(pid_t process) {
  return ::kill(process, 0) == 0 || errno != ESRCH;
}

bool is_ended_process(std::string_view digits) {
  return !digits.empty() && digits.size() <= 9 && std::ranges::all_of(digits, is_digit) &&
         !is_running(std::stoi(std::string(digits)));
}

MemoryFile::MemoryFile(std::string_view bytes) : descriptor_(::memfd_create("bodesmith", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::runtime_error("the system gives no file in memory");
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written <= 0) {
      ::close(descriptor_);
      throw std::runtime_error("a file in memory cannot be written");
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

MemoryFile::~MemoryFile() {
  ::close(descriptor_);
}

std::filesystem::path MemoryFile::path() const {
  return "/proc/self/fd/" + std::to_string(descriptor_);
}

std::string MemoryFile::bytes() const {
  std::ifstream in(path(), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace bodesmith
