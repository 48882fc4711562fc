#pragma once

#include <signal.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace bodesmith {

/// Files and (then empty) folders that a signal which ends the program shall take with it (at most 256 at a time; more
/// are left to OutputSet's next commit). From any thread.
void remember_temporary(const std::filesystem::path& path);
void forget_temporary(const std::filesystem::path& path);

/// A process that shall not outlive this one (at most 64 at a time).
void remember_child(pid_t child);
void forget_child(pid_t child);

/// While it lives, no signal ends the program: what is made and remembered (a file, a folder, a child) is made as one
/// step. From the moment the program ends, no thread gets one any more.
class EndingHeld {
 public:
  EndingHeld();
  ~EndingHeld();
  EndingHeld(const EndingHeld&) = delete;
  EndingHeld& operator=(const EndingHeld&) = delete;

  /// In a child that was forked meanwhile: signals end it as they end any program.
  void forget_in_child() const;

 private:
  sigset_t before_;
};

/// Ends the children, removes what is temporary and ends the program; nothing else of it runs. For handlers of signals.
[[noreturn]] void end_at_once(int status);

/// SIGTERM, SIGHUP and SIGQUIT end at once; a file that grows beyond its limit is a failed write, not a signal.
void catch_endings();

/// Whether that process runs.
bool is_running(pid_t process);
/// Whether these are the digits of the number of one that runs no more.
bool is_ended_process(std::string_view digits);

/// A file without a place on the disk, for libraries that read or write files by name only. It goes with the object.
class MemoryFile {
 public:
  /// Throws std::runtime_error when the system gives none.
  explicit MemoryFile(std::string_view bytes = {});
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::filesystem::path path() const;
  std::string bytes() const;

 private:
  int descriptor_;
};

}  // namespace bodesmith
