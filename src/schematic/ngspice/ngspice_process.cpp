#include "schematic/ngspice/ngspice_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/temporary.hpp"
#include "base/text.hpp"

namespace bodesmith::ngspice {
namespace {

namespace fs = std::filesystem;

/// The program's path, or empty.
std::string find_ngspice() {
  if (const char* named = std::getenv("BODESMITH_NGSPICE"); named != nullptr) {
    return ::access(named, X_OK) == 0 ? named : "";
  }
  const char* path = std::getenv("PATH");
  if (path == nullptr) return {};
  for (const std::string_view folder : split(path, ':')) {
    const std::string candidate = std::string(folder) + "/ngspice";
    if (::access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return {};
}

/// What ngspice reads and writes in its folder.
constexpr const char* kWorkFiles[] = {"deck.cir", "out.txt", "err.txt", "result.txt", "library.sub"};
constexpr std::string_view kWorkName = "bodesmith-spice-";

/// Known to a signal that ends the program, as long as it lives.
class ChildOf {
 public:
  explicit ChildOf(pid_t child) : child_(child) { remember_child(child); }
  ~ChildOf() { forget_child(child_); }
  ChildOf(const ChildOf&) = delete;
  ChildOf& operator=(const ChildOf&) = delete;

 private:
  pid_t child_;
};

/// What the child needs, laid out before it begins: it shares this program's memory until it is another program.
struct Start {
  std::vector<char*> argv;
  std::string folder, out, err;
  pid_t parent;
};

[[noreturn]] void become(const Start& start, const EndingHeld& held) {
  held.forget_in_child();
#ifdef __linux__
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // also when this program is killed so that it cannot say anything
  if (::getppid() != start.parent) ::_exit(126);
#endif
  const int in = ::open("/dev/null", O_RDONLY);
  const int out = ::open(start.out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err = ::open(start.err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (in < 0 || out < 0 || err < 0 || ::chdir(start.folder.c_str()) != 0) ::_exit(126);
  ::dup2(in, 0);
  ::dup2(out, 1);
  ::dup2(err, 2);
  ::execv(start.argv.front(), start.argv.data());
  ::_exit(127);
}

/// Starts `program arguments` in `folder` with its output in out.txt and err.txt; its exit status, or -1
/// after a timeout.
int run_program(const std::string& program, const std::vector<std::string>& arguments, const fs::path& folder,
                double timeout_s) {
  Start start{{const_cast<char*>(program.c_str())},
              folder.string(),
              (folder / "out.txt").string(),
              (folder / "err.txt").string(),
              ::getpid()};
  for (const std::string& argument : arguments) start.argv.push_back(const_cast<char*>(argument.c_str()));
  start.argv.push_back(nullptr);
  std::optional<EndingHeld> until_known(std::in_place);
  // Not fork: after it every page that this program's threads write is copied first, for a child that reads none.
  const pid_t child = ::vfork();
  if (child < 0) throw InputError("ngspice cannot be started: no more processes");
  if (child == 0) become(start, *until_known);
  const ChildOf here(child);
  until_known.reset();
  const auto begin = std::chrono::steady_clock::now();
  const auto deadline = begin + std::chrono::duration<double>(timeout_s);
  for (;;) {
    int status = 0;
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    // Ctrl-C reaches ngspice too: how it ended then says nothing.
    if (ended == child && interrupted()) throw Interrupted();
    if (ended == child) return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    const bool stopped = interrupted();
    if (stopped || std::chrono::steady_clock::now() > deadline) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      if (stopped) throw Interrupted();
      return -1;
    }
    // A sleep is a small part of the run: whoever waits for it stands still meanwhile.
    constexpr std::chrono::steady_clock::duration kShortest = std::chrono::microseconds(200);
    constexpr std::chrono::steady_clock::duration kLongest = std::chrono::milliseconds(20);
    std::this_thread::sleep_for(
        std::clamp((std::chrono::steady_clock::now() - begin) / 50, kShortest, kLongest));
  }
}

/// The first line that reads like an error message.
std::string reported_error(const std::string& text) {
  for (const std::string_view line : split(text, '\n')) {
    const std::string small = lower_case(line);
    if (small.find("error") != std::string::npos || small.find("fatal") != std::string::npos ||
        small.find("unknown") != std::string::npos || small.find("can't find") != std::string::npos) {
      return std::string(trim(line));
    }
  }
  return {};
}

std::string reported_error(const NgspiceOutput& ran) {
  std::string out = reported_error(ran.err);
  return out.empty() ? reported_error(ran.out) : out;
}

}  // namespace

void drop_stale_work_folders(const fs::path& where) {
  std::error_code ec;
  const auto now = fs::file_time_type::clock::now();
  for (fs::directory_iterator it(where, ec), end; !ec && it != end; it.increment(ec)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with(kWorkName)) continue;
    const auto digits = name.substr(kWorkName.size(), name.find('-', kWorkName.size()) - kWorkName.size());
    struct stat about {};
    if (::lstat(it->path().c_str(), &about) != 0 || !S_ISDIR(about.st_mode) || about.st_uid != ::geteuid())
      continue;
    std::error_code ignored;
    if (!is_ended_process(digits) || now - fs::last_write_time(it->path(), ignored) < std::chrono::minutes(1))
      continue;
    fs::remove_all(it->path(), ignored);
  }
}

WorkFolder::WorkFolder() {
  std::error_code ec;
  const fs::path where = fs::temp_directory_path(ec);
  if (ec) throw InputError("TMPDIR is no folder, expected a writable one for temporary files");
  static std::once_flag once;
  std::call_once(once, drop_stale_work_folders, where);
  std::string name = (where / fmt::format("{}{}-XXXXXX", kWorkName, ::getpid())).string();
  const EndingHeld until_remembered;
  if (::mkdtemp(name.data()) == nullptr) {
    throw InputError(fmt::format("{}: cannot be made, expected a writable folder for temporary files", name));
  }
  path_ = name;
  for (const char* file : kWorkFiles) remember_temporary(path_ / file);
  remember_temporary(path_);
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  for (const char* file : kWorkFiles) forget_temporary(path_ / file);
  forget_temporary(path_);
}

NgspiceOutput run_ngspice_in(const fs::path& folder, const std::string& deck, const std::string& what,
                             double timeout_s) {
  const std::string program = find_ngspice();
  if (program.empty()) {
    throw InputError(
        fmt::format("{}: needs ngspice, which is not installed (Debian: apt-get install ngspice)", what));
  }
  write_file(folder / "deck.cir", deck);
  const int status = run_program(program, {"-n", "-b", "deck.cir"}, folder, timeout_s);
  NgspiceOutput ran{read_file(folder / "out.txt"), read_file(folder / "err.txt")};
  if (status == -1) {
    throw InputError(fmt::format("{}: ngspice did not finish within {} s", what, rounded_text(timeout_s)));
  }
  if (status != 0) {
    std::string why = reported_error(ran);
    throw InputError(fmt::format("{}: ngspice ended with {}{}", what, status, why.empty() ? "" : ": " + why));
  }
  return ran;
}

void fail_on_output(const std::string& what, const NgspiceOutput& ran) {
  std::string why = reported_error(ran);
  throw InputError(fmt::format("{}: ngspice gave no result{}", what,
                               why.empty() ? ", expected a circuit that it can solve" : ": " + why));
}

bool is_available() {
  return !find_ngspice().empty();
}

std::string version() {
  const std::string program = find_ngspice();
  if (program.empty()) return {};
  const WorkFolder folder;
  if (run_program(program, {"--version"}, folder.path(), 20.0) != 0) return {};
  const std::string text = read_file(folder.path() / "out.txt");
  const size_t at = text.find("ngspice-");
  if (at == std::string::npos) return {};
  return text.substr(at, text.find_first_of(" \n", at) - at);
}

}  // namespace bodesmith::ngspice
