// Every number of every subcommand, by this program and by one built in another way (BODESMITH_OTHER_PROGRAM: .ci/run
// optimise makes one without optimisation), and the largest difference of each subcommand.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "base/text.hpp"
#include "cli/seeded_inputs.hpp"
#include "run_program.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {

namespace fs = std::filesystem;

constexpr double kSameRelative = 1e-6;
/// Of remainders, whose last digits are rounding, and of errors in percent of what CVODE follows to 1e-9.
constexpr double kSameAbsolute = 1e-7;

/// Netlists and lists of parts have no remainders: a capacitor of picofarads is another one.
bool holds_parts(const std::string& file) {
  return file.find("parts.csv") != std::string::npos || file.ends_with(".sub") || file.ends_with(".cir") ||
         file.ends_with("bom.csv") || file.ends_with("plan.json") || file.ends_with("circuit.json");
}

/// A text as its numbers and what stands around them.
struct NumbersAndRest {
  std::vector<double> numbers;
  std::string rest;
};

NumbersAndRest numbers_and_rest(const std::string& text) {
  NumbersAndRest out;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    // Not what ends a word (R12, sha256 of an input).
    const bool begins = at == 0 || !is_letter_or_digit(text[at - 1]);
    const auto part_of_number = [&](std::size_t i) {
      const char c = text[i];
      return is_digit(c) || c == '.' ||
             ((c == '-' || c == '+') && (i == at || lower_case(text[i - 1]) == 'e')) ||
             (lower_case(c) == 'e' && i > at && i + 1 < text.size() && !is_letter(text[i + 1]));
    };
    while (begins && end < text.size() && part_of_number(end)) ++end;
    double value = 0.0;
    if (end > at && parse_number(std::string_view(text).substr(at, end - at), value)) {
      out.numbers.push_back(value);
      out.rest += '#';
      at = end;
    } else {
      out.rest += text[at++];
    }
  }
  return out;
}

std::map<std::string, std::string> made_by(const std::string& program, const std::string& command) {
  static const char* const timing =
      R"re("(timing_s|wall_s|ngspice_s|compute|seconds)": *(\{[^}]*\}|[-+.0-9e]+))re";
  const TemporaryFolder folder;
  write_seeded_inputs(folder.path());
  const ProgramResult result = run_shell(fmt::format("cd {} && export BODESMITH_NGSPICE=/nowhere && {} {}",
                                                     folder.path().string(), program, command));
  EXPECT_LE(result.status, 1) << command << result.err;
  std::map<std::string, std::string> out = {{"status", std::to_string(result.status)}};
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
    if (entry.is_regular_file())
      out[fs::relative(entry.path(), folder.path()).string()] =
          replaced(read_file(entry.path()), timing, "time");
  }
  return out;
}

TEST(OtherBuild, ComesToTheSameNumbers) {
  const char* const other = std::getenv("BODESMITH_OTHER_PROGRAM");
  if (other == nullptr) GTEST_SKIP() << "BODESMITH_OTHER_PROGRAM names no other program (.ci/run optimise)";
  for (const std::string& command : seeded_commands()) {
    const auto here = made_by(BODESMITH_PROGRAM, command), there = made_by(other, command);
    double worst = 0.0;
    std::string where = "nowhere";
    std::size_t count = 0;
    for (const auto& [file, text] : here) {
      ASSERT_EQ(there.count(file), 1U) << command << ": " << file;
      const NumbersAndRest a = numbers_and_rest(text), b = numbers_and_rest(there.at(file));
      EXPECT_EQ(a.rest, b.rest) << command << ": " << file;
      if (a.numbers.size() != b.numbers.size()) continue;
      count += a.numbers.size();
      for (std::size_t i = 0; i < a.numbers.size(); ++i) {
        const double distance = std::abs(a.numbers[i] - b.numbers[i]);
        const double difference = distance / std::max(std::abs(a.numbers[i]), std::abs(b.numbers[i]));
        if (distance <= (holds_parts(file) ? 0.0 : kSameAbsolute) || difference <= worst) continue;
        worst = difference;
        where = fmt::format("{}: {:.17g} and {:.17g}", file, a.numbers[i], b.numbers[i]);
      }
    }
    fmt::print("{}: {} files, {} numbers, largest difference {:.2g} ({})\n", command, here.size() - 1, count,
               worst, where);
    EXPECT_EQ(here.size(), there.size()) << command;
    EXPECT_LE(worst, kSameRelative) << command;
  }
}

}  // namespace
}  // namespace bodesmith
