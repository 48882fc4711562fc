// The decks of netlists/ that drive the disturbance generator and the whole controller, run in ngspice; what they must give
// is written out here.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <vector>

#include "base/files.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

const std::string kDecks = std::string(BODESMITH_SOURCE_DIR) + "/netlists/first_seed/";

double paper_disturbance(bool rising, double x, double falling_gain) {
  return rising ? x * (0.3546 + x * (-0.6433 + 0.2887 * x))
                : falling_gain * x * (-0.2398 + x * (0.0838 + 0.156 * x));
}

/// Rows of numbers below a line of names.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& path) {
  std::istringstream text(read_file(path));
  std::vector<std::vector<double>> out;
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream words(line);
    out.emplace_back();
    for (double value = 0.0; words >> value;) out.back().push_back(value);
  }
  return out;
}

bool has_ngspice() {
  return run_shell("command -v ngspice").status == 0;
}

/// RMS of what `error` makes of the rows, the two milliseconds behind each turn left out: there the detector's delay shows.
template <class Error>
double rms_between_turns(const std::vector<std::vector<double>>& rows, Error&& error) {
  double sum = 0.0, time = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double phase = std::fmod(rows[i][0], 0.05);
    if (phase < 0.002) continue;
    const double step = rows[i][0] - rows[i - 1][0];
    sum += step * std::pow(error(rows[i], std::fmod(rows[i][0], 0.1) < 0.05), 2);
    time += step;
  }
  return std::sqrt(sum / time);
}

TEST(Decks, TheDisturbanceGeneratorFollowsItsPolynomials) {
  if (!has_ngspice()) GTEST_SKIP() << "ngspice is not installed";
  const TemporaryFolder folder;
  for (const char* file : {"disturbance.cir", "disturbance.sub"})
    std::filesystem::copy_file(kDecks + file, folder / file);
  const ProgramResult run = run_shell("cd " + folder.path().string() + " && ngspice -n -b disturbance.cir");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto rows = rows_of(folder / "disturbance.txt");
  ASSERT_GT(rows.size(), 1000u);
  const double left = rms_between_turns(rows, [](const std::vector<double>& row, bool rising) {
    EXPECT_EQ(row[2] > 0.5, rising) << row[0];
    return row[3] - paper_disturbance(rising, row[1], 1.0);
  });
  EXPECT_LT(left, 5e-4);
}

TEST(Decks, TheControllersDriveSolvesTheStagesEquation) {
  if (!has_ngspice()) GTEST_SKIP() << "ngspice is not installed";
  const TemporaryFolder folder;
  const std::string example = std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/disturbance.json";
  ASSERT_EQ(run_bodesmith("controller " + example + " -o " + (folder / "made").string()).status, 0);
  std::filesystem::copy_file(folder / "made/controller.sub", folder / "controller.sub");
  std::filesystem::copy_file(kDecks + "controller.cir", folder / "controller.cir");
  const ProgramResult run = run_shell("cd " + folder.path().string() + " && ngspice -n -b controller.cir");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto rows = rows_of(folder / "controller.txt");
  ASSERT_GT(rows.size(), 1000u);
  // y = v + K(10 Hz) d(v) is r.
  const double left = rms_between_turns(rows, [](const std::vector<double>& row, bool rising) {
    return row[2] + paper_disturbance(rising, row[2], 1.06) - row[1];
  });
  EXPECT_LT(left, 1e-3);
}

}  // namespace
}  // namespace bodesmith
