#include <fmt/format.h>

#include <clocale>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/version.hpp"
#include "cli/commands.hpp"

namespace {

using bodesmith::cli::commands;

void print_help() {
  fmt::print(
      "Example:\n  bodesmith run examples/nanopositioner/project.toml -o out/nanopositioner\n\n"
      "bodesmith {}: from a target Bode magnitude, or measured records of a piezo stage, to checked analog\n"
      "hardware: FPAA configurations, SPICE netlists, multiplier layouts.\n\nSubcommands "
      "(bodesmith NAME --help):\n",
      bodesmith::kVersion);
  for (const auto& command : commands()) fmt::print("  {:<12}{}\n", command.name, command.what);
}

int run(const std::vector<std::string>& arguments) {
  using namespace bodesmith;
  if (arguments.empty()) {
    print_help();
    return cli::kBadInput;
  }
  if (arguments[0] == "--help" || arguments[0] == "-h" || arguments[0] == "help") {
    print_help();
    return cli::kDone;
  }
  if (arguments[0] == "--version") {
    fmt::print("bodesmith {}\n", kVersion);
    return cli::kDone;
  }
  for (const auto& command : commands()) {
    if (command.name == arguments[0]) return command.run({arguments.begin() + 1, arguments.end()});
  }
  throw InputError(fmt::format("'{}' is not a subcommand, expected one of those that bodesmith --help lists",
                               arguments[0]));
}

}  // namespace

int main(int argc, char** argv) {
  std::setlocale(LC_ALL, "C");
  bodesmith::catch_interrupts();
  try {
    return run({argv + 1, argv + argc});
  } catch (const bodesmith::InputError& error) {
    fmt::print(stderr, "bodesmith: {}\n", error.what());
    return bodesmith::cli::kBadInput;
  } catch (const bodesmith::Interrupted&) {
    fmt::print(stderr, "bodesmith: interrupted\n");
    return 130;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "bodesmith: out of memory\n");
    return bodesmith::cli::kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bodesmith: this is a bug, please report it: {}\n", error.what());
    return bodesmith::cli::kBug;
  }
}
