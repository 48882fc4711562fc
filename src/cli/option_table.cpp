#include "cli/option_table.hpp"

#include "cli/commands.hpp"

namespace bodesmith::cli {

std::string CommandTable::first_sentence() const {
  std::string out;
  for (const char c : what) {
    const bool ends = c == '.' || c == ';' || (c == ':' && out.size() > 20);
    if (ends) break;
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::vector<CommandTable>*& tables_wanted() {
  static std::vector<CommandTable>* wanted = nullptr;
  return wanted;
}

std::vector<CommandTable> command_tables() {
  std::vector<CommandTable> out;
  tables_wanted() = &out;
  for (const Command& command : commands()) {
    command.run({});
    for (const Command& verb : verbs_of(command.name)) verb.run({});
  }
  tables_wanted() = nullptr;
  return out;
}

}  // namespace bodesmith::cli
