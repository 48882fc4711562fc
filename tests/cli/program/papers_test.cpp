// docs/papers.md walked row by row: what it runs ends well, and the figures that it quotes stand in the output.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "base/text.hpp"
#include "run_program.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

struct MapRow {
  std::string item;
  std::string command;
  std::string ours;
};

std::vector<MapRow> map_rows() {
  std::vector<MapRow> out;
  const std::string page = read_file(fs::path(BODESMITH_SOURCE_DIR) / "docs/papers.md");
  for (const std::string_view line : split(page, '\n')) {
    const auto cells = split(line, '|');
    if (cells.size() != 7 || trim(cells[1]) == "item" || trim(cells[1]).starts_with("---")) continue;
    out.push_back({std::string(trim(cells[1])), std::string(trim(cells[2])), std::string(trim(cells[3]))});
  }
  return out;
}

/// What stands between backticks.
std::vector<std::string> quoted(const std::string& cell) {
  std::vector<std::string> out;
  const auto parts = split(cell, '`');
  for (std::size_t i = 1; i < parts.size(); i += 2) out.emplace_back(parts[i]);
  return out;
}

bool is_number(const std::string& word) {
  double ignored = 0.0;
  return parse_number(word, ignored);
}

/// The number itself, or one within 2 %: another compiler may end a search one step further. What rounding alone makes
/// (1e-12 and less) only has to be as small.
bool stands_in(const std::string& output, const std::string& number) {
  double wanted = 0.0;
  parse_number(number, wanted);
  for (const auto& match : matches(output, R"([-+]?\d+\.?\d*([eE][-+]?\d+)?)")) {
    const double got = std::stod(match[0]);
    if (std::abs(wanted) < 1e-12 ? std::abs(got) < 1e-12 && (wanted == 0.0) == (got == 0.0)
                                 : std::abs(got - wanted) <= 0.02 * std::abs(wanted))
      return true;
  }
  return false;
}

/// Output of a row's command; nothing when it is not built (examples are an option).
std::optional<std::string> output_of(std::string command, const TemporaryFolder& folder) {
  if (command.starts_with("example_")) {
    const fs::path program = fs::path(BODESMITH_PROGRAM).parent_path() / command;
    if (!fs::exists(program)) return std::nullopt;
    const ProgramResult result = run_shell(program.string());
    EXPECT_EQ(result.status, 0) << command << result.err;
    return result.out;
  }
  command = replaced(command.substr(std::string("bodesmith ").size()), "OUT", (folder / "out").string());
  const std::string root = BODESMITH_SOURCE_DIR;
  command = replaced(command, "(examples|netlists)/", root + "/$1/");
  const ProgramResult result = run_bodesmith(command);
  EXPECT_EQ(result.status, 0) << command << "\n" << result.err;
  return result.out + result.err;
}

TEST(Papers, TheMapHoldsInEveryRow) {
  const std::vector<MapRow> rows = map_rows();
  ASSERT_GT(rows.size(), 35u);
  const TemporaryFolder folder;
  std::map<std::string, std::optional<std::string>> outputs;
  for (const MapRow& row : rows) {
    const auto commands = quoted(row.command);
    for (const std::string& word : quoted(row.ours)) {
      if (word.find('/') == std::string::npos) continue;
      EXPECT_TRUE(fs::exists(fs::path(BODESMITH_SOURCE_DIR) / word)) << row.item << ": " << word;
    }
    // Only a command that is the whole cell is complete.
    if (commands.size() != 1 || row.command.size() != commands[0].size() + 2) continue;
    if (outputs.count(commands[0]) == 0) outputs[commands[0]] = output_of(commands[0], folder);
    const auto& output = outputs[commands[0]];
    if (!output) continue;
    for (const std::string& word : quoted(row.ours)) {
      if (is_number(word)) {
        EXPECT_TRUE(stands_in(*output, word)) << row.item << ": " << word << "\n" << *output;
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith
