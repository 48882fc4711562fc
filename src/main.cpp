#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <unistd.h>

#include <cerrno>
#include <clocale>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/temporary.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/version_text.hpp"

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

/// Vectors of some hundred kilobytes come and go by the thousand: to give their pages back and ask for them again each time
/// would take longer than the work in them.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMebibyte = 1 << 20;
  ::mallopt(M_MMAP_THRESHOLD, 32 * kMebibyte);
  ::mallopt(M_TRIM_THRESHOLD, 64 * kMebibyte);
#endif
}

int run(const std::vector<std::string>& arguments) {
  using namespace bodesmith;
  if (arguments.empty()) {
    print_help();
    throw InputError("no subcommand given, expected one of those above");
  }
  if (arguments[0] == "--help" || arguments[0] == "-h" || arguments[0] == "help") {
    print_help();
    return cli::kDone;
  }
  const std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
  if (arguments[0] == "--version") return cli::print_version(rest);
  if (const auto* command = cli::find_command(commands(), arguments)) return command->run(rest);
  if (const auto* command = cli::find_command(cli::hidden_commands(), arguments)) return command->run(rest);
  std::vector<std::string> known = {"--help", "--version"};
  for (const auto& command : commands()) known.push_back(command.name);
  throw InputError(
      fmt::format("'{}' is not a subcommand{}, expected one of those that bodesmith --help lists",
                  arguments[0], did_you_mean(arguments[0], known)));
}

}  // namespace

int main(int argc, char** argv) {
  std::setlocale(LC_ALL, "C");
  keep_freed_memory();
  const auto say = [](const std::string& text) {
    bodesmith::hide_progress();
    fmt::print(stderr, "{} {}\n", bodesmith::coloured("bodesmith:", bodesmith::Tone::error, STDERR_FILENO),
               text);
  };
  bodesmith::catch_interrupts();
  bodesmith::catch_endings();
  bodesmith::protect_inputs();
  try {
    const int status = run({argv + 1, argv + argc});
    bodesmith::cli::show_notes();
    // What went to a full disk or a closed pipe is no result.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw bodesmith::InputError(std::string("the summary cannot be written: ") + std::strerror(errno));
    return status;
  } catch (const bodesmith::InputError& error) {
    say(error.what());
    return bodesmith::cli::kBadInput;
  } catch (const bodesmith::Interrupted&) {
    say("interrupted");
    return bodesmith::cli::kInterrupted;
  } catch (const std::bad_alloc&) {
    const std::string file = bodesmith::last_file_read().string();
    say(fmt::format("{}{}{}: takes more memory than there is, expected less data or smaller counts", argv[1],
                    file.empty() ? "" : " with ", file));
    return bodesmith::cli::kBadInput;
  } catch (const std::exception& error) {
    say(std::string("this is a bug, please report it: ") + error.what());
    return bodesmith::cli::kBug;
  }
}
