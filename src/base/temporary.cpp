#include "base/temporary.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

namespace bodesmith {
namespace {

/// Fixed storage: a signal's handler may not allocate. `used` is set when the
/// path stands.
constexpr std::size_t kSlots = 64;
constexpr std::size_t kLongestPath = 4096;
struct Slot {
  std::atomic<bool> used{false};
  std::array<char, kLongestPath> path{};
};
std::array<Slot, kSlots> slots;

void on_ending(int signal) {
  for (Slot& slot : slots) {
    if (slot.used.load()) ::unlink(slot.path.data());
  }
  ::_exit(128 + signal);
}

}  // namespace

void remember_temporary(const std::filesystem::path& path) {
  const std::string text = path.string();
  if (text.size() >= kLongestPath) return;
  for (Slot& slot : slots) {
    if (slot.used.load()) continue;
    std::memcpy(slot.path.data(), text.c_str(), text.size() + 1);
    slot.used.store(true);
    return;
  }
}

void forget_temporary(const std::filesystem::path& path) {
  for (Slot& slot : slots) {
    if (slot.used.load() && path.string() == slot.path.data()) slot.used.store(false);
  }
}

void catch_endings() {
  std::signal(SIGTERM, on_ending);
  std::signal(SIGHUP, on_ending);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace bodesmith
