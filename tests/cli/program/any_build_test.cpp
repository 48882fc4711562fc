// Other compilers and other levels of optimisation round elsewhere, and come to the same figures: within kTolerance of
// those in any_build_figures.txt, which the release build of GCC 12 made (BODESMITH_WRITE_FIGURES=1 writes them anew).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

#include "base/text.hpp"
#include "cli/seeded_inputs.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

namespace fs = std::filesystem;

constexpr double kTolerance = 1e-6;  ///< relative, of the sum over all numbers of a file

struct FileFigure {
  int numbers = 0;
  double sum = 0.0;  ///< of asinh |x|: large and small numbers count alike, remainders of rounding hardly
};

/// Of the numbers outside of quotes.
FileFigure figure_of(const std::string& text) {
  FileFigure out;
  std::string word;
  bool quoted = false;
  const auto take = [&] {
    double value = 0.0;
    if (!word.empty() && parse_number(word, value)) {
      ++out.numbers;
      out.sum += std::asinh(std::abs(value));
    }
    word.clear();
  };
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (!quoted && c != '"' && std::string_view(" \t\n,[]{}:").find(c) == std::string_view::npos) {
      word += c;
    } else {
      take();
    }
  }
  take();
  return out;
}

std::map<std::string, FileFigure> figures_of_this_build() {
  const std::map<std::string, std::string> commands = {
      {"c.json", "fit gains.csv -o c.json"},
      {"approximated.json", "approximate given_cascade.json --order 3 -o approximated.json"},
      {"design.json",
       "design lowpass --family elliptic --order 4 --corner-hz 1000 --ripple-db 0.5 --stop-db 40 -o design.json"},
      {"drive.csv", "compensate model.toml --reference reference.csv -o drive.csv"},
      {"bode.csv", "bode sections.json --count 200 -o bode.csv"},
      {"model_out.toml", "identify record.csv --model prandtl_ishlinskii -o model_out.toml"},
      {"y.csv", "simulate model.toml --input record.csv -o y.csv"},
      {"yield.json", "yield sections.json --samples 3000 --count 5 --seed 3 -o yield.json"},
  };
  const TemporaryFolder folder;
  write_seeded_inputs(folder.path());
  std::map<std::string, FileFigure> out;
  for (const char* file : {"c.json", "approximated.json", "design.json", "drive.csv", "bode.csv",
                           "model_out.toml", "y.csv", "yield.json"}) {
    const ProgramResult result =
        run_shell("cd " + folder.path().string() + " && " + BODESMITH_PROGRAM + " " + commands.at(file));
    EXPECT_EQ(result.status, 0) << result.err;
    std::string text = read_file(folder / file);
    text = text.substr(0, text.find("\"timing_s\""));
    out[file] = figure_of(text);
  }
  return out;
}

TEST(AnyBuild, ComesToTheSameFigures) {
  const fs::path file = fs::path(BODESMITH_SOURCE_DIR) / "tests/cli/any_build_figures.txt";
  const std::map<std::string, FileFigure> figures = figures_of_this_build();
  if (std::getenv("BODESMITH_WRITE_FIGURES") != nullptr) {
    std::string text;
    for (const auto& [name, figure] : figures)
      text += fmt::format("{} {} {:.12g}\n", name, figure.numbers, figure.sum);
    write_file(file, text);
  }
  std::istringstream lines(read_file(file));
  std::string name;
  FileFigure expected;
  std::size_t seen = 0;
  for (; lines >> name >> expected.numbers >> expected.sum; ++seen) {
    ASSERT_EQ(figures.count(name), 1U) << name;
    EXPECT_EQ(figures.at(name).numbers, expected.numbers) << name;
    EXPECT_NEAR(figures.at(name).sum, expected.sum, kTolerance * expected.sum) << name;
  }
  EXPECT_EQ(seen, figures.size());
}

}  // namespace
}  // namespace bodesmith
