#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

#include "base/files.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {

struct ProgramResult {
  int status = -1;
  std::string out;
  std::string err;
};

/// Runs `command` by the shell and keeps what it said.
inline ProgramResult run_shell(const std::string& command) {
  const TemporaryFolder folder;
  const std::string full = "( " + command + " ) >'" + (folder / "out").string() + "' 2>'" +
                           (folder / "err").string() + "' </dev/null";
  ProgramResult result;
  const int status = std::system(full.c_str());
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = read_file(folder / "out");
  result.err = read_file(folder / "err");
  return result;
}

/// Runs `bodesmith arguments`.
inline ProgramResult run_bodesmith(const std::string& arguments) {
  return run_shell(std::string(BODESMITH_PROGRAM) + " " + arguments);
}

}  // namespace bodesmith
