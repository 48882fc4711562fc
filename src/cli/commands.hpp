#pragma once

#include <string>
#include <vector>

namespace bodesmith::cli {

/// Exit status of the program (contract).
enum ExitStatus : int {
  kDone = 0,
  kLimitMissed = 1,  ///< done, but a limit that the user asked for is not met
  kBadInput = 2,
  kBug = 3,
  kInterrupted = 130,  ///< stopped by the user; what there was until then is kept
};

struct Command {
  std::string name;
  std::string what;
  int (*run)(const std::vector<std::string>& arguments);
};

/// One line a subcommand; each lives in a file of its own, <name>_command.cpp.
const std::vector<Command>& commands();

}  // namespace bodesmith::cli
