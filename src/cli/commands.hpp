#pragma once

#include <string>
#include <string_view>
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
/// Those that --help does not list: for the build.
const std::vector<Command>& hidden_commands();
/// The subcommands below one: `fpaa streams`.
const std::vector<Command>& verbs_of(std::string_view command);
const std::vector<Command>& fpaa_verbs();
const std::vector<Command>& yield_verbs();

/// The one that the first argument names; null when it names none.
const Command* find_command(const std::vector<Command>& among, const std::vector<std::string>& arguments);

}  // namespace bodesmith::cli
