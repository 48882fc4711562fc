#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/documents/document.hpp"
#include "numeric/random.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

/// One lag at 100 Hz delayed by 1 ms, in CSV, with noise of about .03 dB and .2 degrees.
std::string delayed_lag() {
  std::string text = "frequency_hz,magnitude_db,phase_deg\n";
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const double f = std::pow(10.0, 1.0 + i / 100.0);
    const double ripple = 0.03 * random.normal();
    text += std::to_string(f) + "," + std::to_string(-10.0 * std::log10(1.0 + f * f / 1e4) + ripple) + "," +
            std::to_string(-std::atan(f / 100.0) * 57.29577951 - 0.36 * f + 0.2 * random.normal()) + "\n";
  }
  return text;
}

TEST(FitMeasuredCommand, WritesSectionsWithADelayThatHardwareLeavesOut) {
  const TemporaryFolder folder;
  write_file(folder / "m.csv", delayed_lag());
  const std::string out = (folder / "s.json").string();
  const auto result = run_bodesmith("fit --measured " + (folder / "m.csv").string() + " --json -o " + out);
  ASSERT_EQ(result.status, 0) << result.err;
  const Node summary = parse_json(result.out, "stdout");
  EXPECT_EQ(summary.at("order").number(), 1.0);
  EXPECT_NEAR(summary.at("poles")[0].at("frequency_hz").number(), 100.0, 1.0);
  EXPECT_NEAR(parse_json(read_file(out), out).at("delay_s").number(), 1e-3, 1e-5);
  const auto board = run_bodesmith("spice " + out + " -o " + (folder / "spice").string());
  EXPECT_EQ(board.status, 0) << board.err;
  EXPECT_NE(board.err.find("is left out"), std::string::npos) << board.err;
}

TEST(FitMeasuredCommand, RefusesInOneLine) {
  const TemporaryFolder folder;
  const std::string to = " -o " + (folder / "s.json").string();
  write_file(folder / "few.csv", "frequency_hz,magnitude_db,phase_deg\n1,0,0\n2,0,0\n");
  write_file(folder / "m.csv", delayed_lag());
  for (const std::string& arguments : {" --measured " + (folder / "few.csv").string(),
                                       " --measured " + (folder / "m.csv").string() + " --order 61",
                                       " --measured " + (folder / "none.csv").string(),
                                       " --direct --order 2 --measured " + (folder / "m.csv").string()}) {
    const auto result = run_bodesmith("fit" + arguments + to);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

}  // namespace
}  // namespace bodesmith
