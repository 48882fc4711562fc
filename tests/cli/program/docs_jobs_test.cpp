// The pages in docs/jobs/ run line by line: every command of their sh blocks, and what the text block behind it quotes.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "base/text.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

/// Commands, and the lines that stand below them.
struct DocumentedStep {
  std::vector<std::string> commands;
  std::vector<std::string> quoted;
};

std::vector<DocumentedStep> steps_of(const fs::path& page) {
  std::vector<DocumentedStep> out;
  std::istringstream lines(read_file(page));
  enum { prose, shell, text } in = prose;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      in = in != prose ? prose : line == "```sh" ? shell : line == "```text" ? text : prose;
      if (in == shell) out.emplace_back();
      continue;
    }
    if (in == shell && !line.empty()) out.back().commands.push_back(line);
    if (in == text && !line.empty()) out.back().quoted.push_back(line);
  }
  return out;
}

std::vector<std::string> split_words(const std::string& text) {
  std::istringstream words(text);
  std::vector<std::string> out;
  for (std::string word; words >> word;) out.push_back(word);
  return out;
}

/// The same word; of numbers those within a tenth, since another compiler may end a search one part further.
/// Without the marks of a sentence round it.
std::string bare(std::string word) {
  while (!word.empty() && std::string(",;:)").find(word.back()) != std::string::npos) word.pop_back();
  while (!word.empty() && word.front() == '(') word.erase(0, 1);
  return word;
}

/// The same word; of numbers those within a tenth, since another compiler may end a search one part further.
bool same_word(const std::string& quoted, const std::string& said) {
  if (bare(quoted) == bare(said)) return true;
  double a = 0.0;
  double b = 0.0;
  if (!parse_number(bare(said), b)) return false;
  // "0.00" quotes the first digits of something small.
  if (quoted == "0.00") return std::abs(b) < 0.01;
  return parse_number(bare(quoted), a) && std::abs(a - b) <= 0.1 * std::abs(a);
}

bool line_quotes(const std::string& line, const std::vector<std::string>& quoted) {
  const std::vector<std::string> said = split_words(line);
  for (std::size_t from = 0; from + quoted.size() <= said.size(); ++from) {
    std::size_t i = 0;
    while (i < quoted.size() && same_word(quoted[i], said[from + i])) ++i;
    if (i == quoted.size()) return true;
  }
  return false;
}

bool says(const std::string& output, const std::string& quoted) {
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    if (line_quotes(line, split_words(quoted))) return true;
  }
  return false;
}

class DocumentedJob : public ::testing::TestWithParam<const char*> {};

/// Examples that run from the repository alone.
class DocumentedExample : public ::testing::TestWithParam<const char*> {};

void run_page(const std::vector<DocumentedStep>& steps) {
  const fs::path source = BODESMITH_SOURCE_DIR;
  const TemporaryFolder folder;
  fs::create_directory_symlink(source / "examples", folder / "examples");
  const std::string enter = "cd '" + folder.path().string() + "' && PATH='" +
                            fs::path(BODESMITH_PROGRAM).parent_path().string() + "':\"$PATH\" ";
  std::size_t quotes = 0;
  for (const DocumentedStep& step : steps) {
    std::string said;
    for (const std::string& command : step.commands) {
      const ProgramResult result = run_shell(enter + command);
      ASSERT_EQ(result.status, 0) << command << "\n" << result.out << result.err;
      said += result.out + result.err;
    }
    for (const std::string& line : step.quoted) {
      EXPECT_TRUE(says(said, line)) << "not said: " << line << "\nbut: " << said;
      ++quotes;
    }
  }
  EXPECT_GE(quotes, 2u);
}

TEST_P(DocumentedJob, RunsLineByLine) {
  const auto steps = steps_of(fs::path(BODESMITH_SOURCE_DIR) / "docs/jobs" / GetParam());
  ASSERT_GE(steps.size(), 4u);
  run_page(steps);
}

TEST_P(DocumentedExample, RunsFromTheRepositoryAlone) {
  const auto steps = steps_of(fs::path(BODESMITH_SOURCE_DIR) / "examples" / GetParam() / "README.md");
  ASSERT_GE(steps.size(), 1u);
  run_page(steps);
}

TEST(Readme, SaysWhatTheProgramSays) {
  const fs::path page = fs::path(BODESMITH_SOURCE_DIR) / "README.md";
  const auto steps = steps_of(page);
  ASSERT_GE(steps.size(), 1u);
  run_page(steps);
  std::istringstream lines(read_file(page));
  int count = 0;
  for (std::string line; std::getline(lines, line);) ++count;
  EXPECT_LE(count, 120) << "what somebody reads in three minutes";
}

// A suite for each page: ctest runs several at once.
INSTANTIATE_TEST_SUITE_P(Picma, DocumentedExample, ::testing::Values("picma_gap"));
INSTANTIATE_TEST_SUITE_P(Slew, DocumentedExample, ::testing::Values("opamp_slew"));
INSTANTIATE_TEST_SUITE_P(Silverbox, DocumentedExample, ::testing::Values("silverbox"));
INSTANTIATE_TEST_SUITE_P(Audio, DocumentedJob, ::testing::Values("audio.md"));
INSTANTIATE_TEST_SUITE_P(Piezo, DocumentedJob, ::testing::Values("piezo.md"));
INSTANTIATE_TEST_SUITE_P(Pid, DocumentedJob, ::testing::Values("fractional_pid.md"));
INSTANTIATE_TEST_SUITE_P(Loop, DocumentedJob, ::testing::Values("loop.md"));
INSTANTIATE_TEST_SUITE_P(Board, DocumentedJob, ::testing::Values("board.md"));
INSTANTIATE_TEST_SUITE_P(FaultyBoard, DocumentedJob, ::testing::Values("faulty_board.md"));
INSTANTIATE_TEST_SUITE_P(Measured, DocumentedJob, ::testing::Values("measured.md"));

}  // namespace
}  // namespace bodesmith
