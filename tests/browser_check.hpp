#pragma once

#include <string>

#include "run_program.hpp"

namespace bodesmith {

/// Why a page cannot be driven here ("chromium is not installed"); empty: it can.
inline std::string no_browser() {
  for (const char* program : {"chromium", "python3"}) {
    if (run_shell(std::string("command -v ") + program).status != 0)
      return std::string(program) + " is not installed";
  }
  return {};
}

/// Drives a page by a script of tests/report/ (which says what it expects); what it prints is what is wrong.
inline ProgramResult drive_page(const std::string& script, const std::string& arguments) {
  return run_shell("timeout 120 python3 -B " BODESMITH_SOURCE_DIR "/tests/report/" + script + " " +
                   arguments);
}

}  // namespace bodesmith
