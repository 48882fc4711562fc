#pragma once

#include <filesystem>
#include <string>

namespace bodesmith::ngspice {

/// Whether an ngspice program is found on PATH (or named by the environment variable BODESMITH_NGSPICE).
bool is_available();
/// What `ngspice --version` calls itself ("ngspice-39"), or empty.
std::string version();

/// Removes work folders in `where` that a killed run left: their process is gone, and they are this user's and older than
/// a minute. The first WorkFolder of a process does so.
void drop_stale_work_folders(const std::filesystem::path& where);

/// A folder for one run, removed at the end, also when a signal ends the program.
class WorkFolder {
 public:
  WorkFolder();
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What ngspice wrote to its standard output and error.
struct NgspiceOutput {
  std::string out;
  std::string err;
};

/// Runs the deck in `folder`. Throws InputError when ngspice is not installed, ends with an error or takes
/// longer than `timeout_s`; `what` (a file name) leads the message.
NgspiceOutput run_ngspice_in(const std::filesystem::path& folder, const std::string& deck,
                             const std::string& what, double timeout_s);
/// Throws InputError: the run ended well and gave no result.
[[noreturn]] void fail_on_output(const std::string& what, const NgspiceOutput& ran);

}  // namespace bodesmith::ngspice
