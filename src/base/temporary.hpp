#pragma once

#include <filesystem>

namespace bodesmith {

/// Files that a signal which ends the program shall take with it (at most 64 at a time; more are left to
/// OutputSet's next commit).
void remember_temporary(const std::filesystem::path& path);
void forget_temporary(const std::filesystem::path& path);

/// SIGTERM and SIGHUP remove them and end the program; a file that grows beyond its limit is a failed write, not
/// a signal.
void catch_endings();

}  // namespace bodesmith
