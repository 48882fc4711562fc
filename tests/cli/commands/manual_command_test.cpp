// Manual pages and completions hold every option of the tables that parse the command line.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/files.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "run_program.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::cli {
namespace {
using testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::size_t count_of(const std::string& text, const std::string& wanted) {
  std::size_t out = 0;
  for (std::size_t at = 0; (at = text.find(wanted, at)) != std::string::npos; ++at) ++out;
  return out;
}

TEST(Manual, PagesHoldEveryOptionWithItsDefaultWordsAndHeading) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_bodesmith("manual -o " + folder.path().string()).status, 0);
  const auto all = command_tables();
  ASSERT_GT(all.size(), 20u);
  for (const CommandTable& table : all) {
    const std::string name = "bodesmith-" + replaced(table.name, " ", "-");
    std::string upper = name;
    std::ranges::transform(upper, upper.begin(),
                           [](char c) { return c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c; });
    const std::string page = replaced(replaced(read_file(folder / (name + ".1")), "\\-", "-"), "\\e", "\\");
    EXPECT_THAT(page, HasSubstr("\n.TH " + upper + " 1 "));
    EXPECT_THAT(page, HasSubstr("\n" + name + " - " + table.first_sentence() + "\n"));
    EXPECT_THAT(page, HasSubstr("\n" + table.example + "\n"));
    if (!table.positional.empty()) {
      EXPECT_THAT(page, HasSubstr("\n.I " + table.positional + "\n"));
    }
    EXPECT_EQ(count_of(page, "\n.nf\n"), count_of(page, "\n.fi\n")) << name;
    std::string heading;
    std::size_t headings = 0;
    for (const OptionEntry& option : table.options) {
      if (option.group != heading) ++headings;
      heading = option.group;
      EXPECT_EQ(count_of(page, "\n.SS " + heading + "\n"), 1u) << name << ": " << heading;
      const std::string value = option.several ? "value …" : "value",
                        both = "-" + option.letter + " \", --" + option.name;
      const std::string tag = option.takes_value && option.letter.empty()
                                  ? "\n.BI --" + option.name + " \" " + value + "\"\n"
                              : option.takes_value    ? "\n.BI " + both + " \" \"" + value + "\"\n"
                              : option.letter.empty() ? "\n.B --" + option.name + "\n"
                                                      : "\n.BR " + both + "\"\n";
      const std::size_t at = page.find(tag);
      ASSERT_NE(at, std::string::npos) << name << tag;
      std::string said = page.substr(at + 1, page.find("\n.", at + 1) - at);
      if (!option.default_text.empty()) {
        EXPECT_THAT(said, HasSubstr("(default: " + option.default_text + ")"));
      }
      if (!option.words.empty()) {
        EXPECT_THAT(said, HasSubstr("; one of: " + join(option.words, ", ")));
      }
    }
    EXPECT_EQ(count_of(page, "\n.SS "), headings) << name;
    // fpaa and fpaa trim name each other; spice and sc do not.
    const std::string see = page.substr(page.find(".SH SEE ALSO"));
    for (const CommandTable& other : all) {
      const bool kin = other.name.starts_with(table.name + " ") || table.name.starts_with(other.name + " ");
      EXPECT_EQ(see.find("bodesmith-" + replaced(other.name, " ", "-") + " (1)") != std::string::npos, kin)
          << name;
    }
  }
}

TEST(Completion, EveryShellIsOfferedWhatTheTablesHave) {
  const std::string zsh = run_bodesmith("completion zsh").out, fish = run_bodesmith("completion fish").out;
  std::string script = "eval \"$(" BODESMITH_PROGRAM " completion bash)\"\n", wanted;
  for (const CommandTable& table : command_tables()) {
    script += "_bodesmith_options '" + table.name + "'\n";
    const std::string function = "_bodesmith_" + replaced(table.name, " ", "_") + "() {";
    const std::size_t at = zsh.find(function);
    ASSERT_NE(at, std::string::npos) << function;
    const std::string own = zsh.substr(at, zsh.find("\n}\n", at) - at);
    std::vector<std::string> dashed;
    for (const OptionEntry& option : table.options) {
      dashed.push_back("--" + option.name);
      if (!option.letter.empty()) dashed.push_back("-" + option.letter);
      const std::string start = !option.letter.empty()
                                    ? "{-" + option.letter + ",--" + option.name + "}'["
                                    : std::string(option.several ? "'*--" : "'--") + option.name + "[";
      const std::size_t place = own.find(start);
      ASSERT_NE(place, std::string::npos) << table.name << start;
      const std::string line = own.substr(place + start.size(), own.find('\n', place) - place - start.size());
      // What is said is as much of the option's own text as stands in 70 signs, whole words of it.
      std::string said = line.substr(0, line.find(']'));
      if (said.ends_with(" …")) said.resize(said.size() - 4);
      EXPECT_LE(said.size(), 70u);
      EXPECT_TRUE(option.what.size() <= 70 || said.size() > 40) << said;
      EXPECT_EQ(line.find("]:" + option.name + ":") != std::string::npos, option.takes_value) << line;
      if (!option.words.empty()) {
        EXPECT_THAT(line, HasSubstr(":(" + join(option.words, " ") + ")'"));
      }
      EXPECT_THAT(fish, HasSubstr("-l " + option.name));
      script += fmt::format("_bodesmith_values '{}' '--{}'\n", table.name, option.name);
    }
    wanted += join(dashed, " ") + "\n";
    for (const OptionEntry& option : table.options) {
      if (option.takes_value) wanted += (option.words.empty() ? "any" : join(option.words, " ")) + "\n";
    }
    const bool files = own.find(":file:_files") != std::string::npos;
    const auto pieces = split(table.positional, '|');
    const bool words = pieces.size() > 1 && std::ranges::none_of(pieces, [](std::string_view one) {
                         return one.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != one.npos;
                       });
    EXPECT_EQ(files, !words && !table.positional.empty())
        << table.name << table.positional << own.substr(own.size() - 80);
    const bool all_json = std::ranges::all_of(pieces, [](std::string_view one) {
      return one.find(".json") != one.npos && one.find(' ') == one.npos;
    });
    EXPECT_EQ(own.find("-g \"*.json\"") != std::string::npos, all_json) << table.positional;
  }
  // Options first, then the values of each, command by command: as bash has them.
  const TemporaryFolder folder;
  write_file(folder / "ask.bash", script);
  EXPECT_EQ(run_shell("bash " + (folder / "ask.bash").string()).out, wanted);
}

}  // namespace
}  // namespace bodesmith::cli
