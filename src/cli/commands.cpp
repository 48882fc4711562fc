#include "cli/commands.hpp"

#include <algorithm>

/// The subcommands in the order of `bodesmith --help`: one line each. run_NAME stands in NAME_command.cpp.
#define BODESMITH_COMMANDS(COMMAND)                                            \
  COMMAND(run, "a project file to checked hardware and a report")              \
  COMMAND(design, "standard filters and equalisers to sections")               \
  COMMAND(fit, "Bode points to a fractional cascade, or directly to sections") \
  COMMAND(approximate, "a fractional cascade to integer pole-zero sections")   \
  COMMAND(fpaa, "sections to FPAA filter blocks on a board")                   \
  COMMAND(spice, "sections to op-amp circuits, netlists and parts")            \
  COMMAND(sc, "response and noise of a switched-capacitor netlist")            \
  COMMAND(layout, "a disturbance generator to multipliers and a switch")       \
  COMMAND(controller, "a whole analog controller as one checked circuit")      \
  COMMAND(bode, "frequency responses of any of these files in one table")      \
  COMMAND(export, "sections, responses and records for other programs")        \
  COMMAND(tune, "a measured plant to a controller with margins")               \
  COMMAND(simulate, "a model's output for an input record")                    \
  COMMAND(identify, "measured records to a model")                             \
  COMMAND(model, "sections, circuits, stages and runs as a model")             \
  COMMAND(compensate, "a model's inverse: the drive for a required output")    \
  COMMAND(diagnose, "names what a model is missing")                           \
  COMMAND(yield, "tolerance and mismatch statistics of a realised design")     \
  COMMAND(new, "a commented project to begin with")                            \
  COMMAND(schema, "JSON Schemas of all files, for editors and validators")     \
  COMMAND(completion, "completion of options for bash, zsh and fish")

namespace bodesmith::cli {

#define BODESMITH_DECLARE_COMMAND(name, what) int run_##name(const std::vector<std::string>& arguments);
BODESMITH_COMMANDS(BODESMITH_DECLARE_COMMAND)
#undef BODESMITH_DECLARE_COMMAND

const std::vector<Command>& commands() {
#define BODESMITH_LIST_COMMAND(name, what) {#name, what, run_##name},
  static const std::vector<Command> all = {BODESMITH_COMMANDS(BODESMITH_LIST_COMMAND)};
#undef BODESMITH_LIST_COMMAND
  return all;
}

int run_manual(const std::vector<std::string>& arguments);

const std::vector<Command>& hidden_commands() {
  static const std::vector<Command> all = {{"manual", "manual pages of all subcommands", run_manual}};
  return all;
}

const std::vector<Command>& verbs_of(std::string_view command) {
  static const std::vector<Command> none;
  if (command == "fpaa") return fpaa_verbs();
  if (command == "yield") return yield_verbs();
  return none;
}

const Command* find_command(const std::vector<Command>& among, const std::vector<std::string>& arguments) {
  if (arguments.empty()) return nullptr;
  const auto found = std::ranges::find(among, arguments[0], &Command::name);
  return found == among.end() ? nullptr : &*found;
}

}  // namespace bodesmith::cli

#undef BODESMITH_COMMANDS
