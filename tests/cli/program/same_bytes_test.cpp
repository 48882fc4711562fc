// The same seed gives the same bytes, twice in a row, on one core and on all of them; every subcommand.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <locale.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "cli/seeded_inputs.hpp"
#include "run_program.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {

namespace fs = std::filesystem;

/// Every file below a folder, by name, without what tells the time.
std::string contents(const fs::path& folder) {
  static const char* const timing =
      R"re("(timing_s|wall_s|ngspice_s|compute|seconds)": *(\{[^}]*\}|[-+.0-9e]+))re";
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string out;
  for (const fs::path& file : files)
    out += fs::relative(file, folder).string() + "\n" + replaced(read_file(file), timing, "time") + "\n";
  return out;
}

TEST(SameBytes, EverySubcommandIsAmongTheCommands) {
  const ProgramResult help = run_bodesmith("--help");
  int found = 0;
  const std::size_t begin = help.out.find("Subcommands");
  ASSERT_NE(begin, std::string::npos);
  const std::string list = help.out.substr(begin);
  for (const auto& line : matches(list, "\n  ([a-z]+) +[A-Za-z]")) {
    ++found;
    const std::string name = line[1] + " ";
    EXPECT_TRUE(std::any_of(seeded_commands().begin(), seeded_commands().end(),
                            [&](const std::string& command) {
                              return command.starts_with(name) ||
                                     command.find("$BODESMITH " + name) != std::string::npos;
                            }))
        << name;
  }
  EXPECT_GE(found, 15);
}

/// What a command makes of the inputs in a folder of that name; `before` stands before the program.
std::string made_in(const fs::path& at, const std::string& before, const std::string& command) {
  fs::remove_all(at);
  fs::create_directories(at);
  write_seeded_inputs(at);
  const ProgramResult result =
      run_shell(fmt::format("cd {} && export BODESMITH_NGSPICE=/nowhere BODESMITH={} && {}$BODESMITH {}",
                            at.string(), BODESMITH_PROGRAM, before, command));
  EXPECT_LE(result.status, 1) << command << result.err;
  return contents(at);
}

/// What it makes on all cores with the C locale, worked out once for all tests.
const std::string& made_plainly(const std::string& command) {
  static std::map<std::string, std::string> known;
  const auto found = known.find(command);
  if (found != known.end()) return found->second;
  const TemporaryFolder folder;
  return known.emplace(command, made_in(folder / "0", "LC_ALL=C ", command)).first->second;
}

TEST(SameBytes, TwiceInARowAndWhateverTheNumberOfCores) {
  if (run_shell("taskset -c 0 true").status != 0) GTEST_SKIP() << "taskset is not there";
  const TemporaryFolder folder;
  for (const std::string& command : seeded_commands())
    EXPECT_EQ(made_plainly(command), made_in(folder / "1", "taskset -c 0 ", command)) << command;
}

// Decimal commas, and an i whose capital is another letter.
TEST(SameBytes, WhateverTheLocale) {
  const TemporaryFolder folder;
  std::vector<std::string> locales;
  for (const char* name : {"de_DE.UTF-8", "tr_TR.UTF-8"}) {
    const locale_t found = ::newlocale(LC_ALL_MASK, name, nullptr);
    if (found == nullptr) continue;
    ::freelocale(found);
    locales.emplace_back(name);
  }
  if (locales.empty())
    GTEST_SKIP() << "neither de_DE.UTF-8 nor tr_TR.UTF-8 is installed (Debian: locales, locale-gen)";
  for (const std::string& command : seeded_commands()) {
    for (const std::string& name : locales)
      EXPECT_EQ(made_plainly(command), made_in(folder / "1", "LC_ALL=" + name + " ", command))
          << name << ": " << command;
  }
}

}  // namespace
}  // namespace bodesmith
