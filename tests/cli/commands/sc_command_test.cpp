// sc as a user calls it: a track-and-hold in closed form, and the sums of its table.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
#include "signal/csv.hpp"
#include "temporary_folder.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {

class ScCommand : public testing::Test {
 protected:
  ScCommand() {
    write_file(
        folder_ / "hold.sc",
        ".clock main 1meg\n.clock slow 1k\nV1 in 0\nS1 in b main.1\nC1 b 0 1p\nC2 d 0 1p\nS2 b d slow.1\n"
        "S3 d 0 slow.2\n.output b\n");
    write_file(folder_ / "one.sc", ".clock main 1meg\nV1 in 0\nS1 in b main.1\nC1 b 0 1p\n.output b\n");
  }
  ProgramResult run(const std::string& arguments) const {
    return run_shell("cd " + folder_.path().string() + " && " BODESMITH_PROGRAM " sc " + arguments +
                     " -o out.csv");
  }
  Json summary(const std::string& arguments) const {
    const ProgramResult result = run(arguments + " --json");
    EXPECT_EQ(result.status, 0) << result.err;
    return parsed(result.out);
  }
  Csv table() const { return Csv::parse(read_file(folder_ / "out.csv"), "out.csv"); }

 private:
  TemporaryFolder folder_;
};

TEST_F(ScCommand, CountsWhatTheNetlistHas) {
  EXPECT_EQ(run("one.sc --count 2").out.substr(0, 36), "1 capacitors, 1 switches, 0 op-amps\n");
  EXPECT_EQ(run("hold.sc --count 2").out.substr(0, 36), "2 capacitors, 3 switches, 0 op-amps\n");
}

TEST_F(ScCommand, TheBandIsOfAllClocksAndTheResponseTheClosedForm) {
  // Of two clocks: a thousandth of the slower one to half the faster one.
  const Json two = summary("hold.sc --count 2");
  EXPECT_DOUBLE_EQ(two["band_hz"][0].get<double>(), 1.0);
  EXPECT_DOUBLE_EQ(two["band_hz"][1].get<double>(), 5e5);
  EXPECT_FALSE(two.contains("noise_v"));
  summary("one.sc --from-hz 1e4 --to-hz 9e5 --count 7");
  const Csv csv = table();
  ASSERT_EQ(csv.rows(), 7u);
  EXPECT_FALSE(csv.has("noise_v_per_rthz"));
  for (std::size_t i = 0; i < 7; ++i) {
    const double f = csv.column("frequency_hz")[i], quarter = 0.5 * std::numbers::pi * f * 1e-6;
    EXPECT_NEAR(f, 1e4 * std::pow(90.0, static_cast<double>(i) / 6.0), 1e-6);
    // Half a period as it is, half a period what it was at its beginning.
    const std::complex<double> wanted = 0.5 + 0.5 * std::sin(quarter) / quarter * std::polar(1.0, -quarter);
    EXPECT_NEAR(csv.column("magnitude_db")[i], 20.0 * std::log10(std::abs(wanted)), 1e-9);
    EXPECT_NEAR(csv.column("phase_deg")[i], std::arg(wanted) * 180.0 / std::numbers::pi, 1e-9);
  }
  EXPECT_EQ(run("one.sc --from-hz 10 --to-hz 10").status, 2);
}

TEST_F(ScCommand, NoiseIsTheAreaOfItsDensityAndGoesWithTheRootOfTheTemperature) {
  const double cold =
      summary("one.sc --noise --from-hz 10 --to-hz 5e5 --count 40 --temperature-k 150")["noise_v"];
  const double warm =
      summary("one.sc --noise --from-hz 10 --to-hz 5e5 --count 40 --temperature-k 600")["noise_v"];
  EXPECT_NEAR(warm / cold, 2.0, 1e-9);
  const Csv csv = table();
  EXPECT_FALSE(csv.has("magnitude_db"));
  const auto& f = csv.column("frequency_hz");
  const auto& density = csv.column("noise_v_per_rthz");
  double square = 0.0;
  for (std::size_t i = 1; i < f.size(); ++i)
    square += 0.5 * (std::pow(density[i], 2) + std::pow(density[i - 1], 2)) * (f[i] - f[i - 1]);
  EXPECT_NEAR(warm, std::sqrt(square), 1e-12 * warm);
  // A part of kT/C.
  EXPECT_LT(warm, std::sqrt(1.380649e-23 * 600.0 / 1e-12));
  EXPECT_GT(warm, 0.4 * std::sqrt(1.380649e-23 * 600.0 / 1e-12));
  summary("one.sc --noise --ac --count 3");
  EXPECT_TRUE(table().has("magnitude_db") && table().has("noise_v_per_rthz"));
}

}  // namespace
}  // namespace bodesmith
