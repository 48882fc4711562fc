#pragma once

#include <string>
#include <vector>

namespace bodesmith::cli {

/// One option of a subcommand, as its Boost.Program_options description has it.
struct OptionEntry {
  std::string name;    ///< without the dashes
  std::string letter;  ///< of a short form; empty where there is none
  std::string group;   ///< heading of --help under which it stands
  std::string what;
  std::string default_text;
  std::vector<std::string> words;  ///< values that are words; empty: any text or number
  bool takes_value = false;
  bool several = false;  ///< several values, or may be given several times
};

/// What a subcommand takes: the same that --help shows, for manual pages and shells. CommandLine::table() makes it from the
/// descriptions that parse the command line, so that there is no second list.
struct CommandTable {
  std::string name;  ///< "fit", "fpaa streams"
  std::string example;
  std::string what;
  std::string positional;
  bool reads_measurements = false;
  std::vector<OptionEntry> options;

  /// The first sentence of `what`, without its full stop.
  std::string first_sentence() const;
};

/// Where CommandLine::parse() puts its table instead of parsing; null as a rule.
std::vector<CommandTable>*& tables_wanted();

/// The tables of all subcommands, and of those below them, in the order of `bodesmith --help`.
std::vector<CommandTable> command_tables();

}  // namespace bodesmith::cli
