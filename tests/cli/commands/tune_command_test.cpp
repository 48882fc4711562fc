// What tune writes and says, worked out again from the plant 1/(1 + s/1000) exp(-s/5000) and the controller's own keys.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
#include "temporary_folder.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {
using testing::HasSubstr;
using Complex = std::complex<double>;

class TuneCommand : public testing::Test {
 protected:
  TuneCommand() {
    write_file(folder_ / "plant.json",
               R"({"schema": "bodesmith.sections/1", "gain": 1, "delay_s": 2e-4, "sections": [{"gain": 1000.0,
 "zeros_rad_s": [], "poles_rad_s": [[-1000, 0]]}]})");
  }
  ProgramResult run(const std::string& options) const {
    return run_shell("cd " + folder_.path().string() +
                     " && " BODESMITH_PROGRAM " tune plant.json -o c.json " + options);
  }
  Json resonant_loop(double bandwidth_hz) const {
    write_file(folder_ / "stage.json",
               R"({"schema": "bodesmith.sections/1", "gain": 1, "sections": [{"gain": 1e6,
 "zeros_rad_s": [], "poles_rad_s": [[-30, 1000], [-30, -1000]]}]})");
    const ProgramResult bode = run_shell(
        fmt::format("cd {0} && {1} tune stage.json --kind pid --bandwidth-hz {2} --sections s.json -o c.json "
                    ">/dev/null && {1} bode s.json stage.json --series --margins --json -o b.csv",
                    folder_.path().string(), BODESMITH_PROGRAM, bandwidth_hz));
    EXPECT_EQ(bode.status, 0) << bode.err;
    return parsed(bode.out);
  }
  static Complex plant(Complex s) { return std::exp(-s * 2e-4) / (1.0 + s / 1e3); }
  /// kp + ki/s + kd s/(1 + s/corner), the last with the roll-off that the keys say.
  static Complex pid(const Json& c, Complex s) {
    Complex out = c["kp"].get<double>() + c["ki_per_s"].get<double>() / s;
    if (c.contains("kd_s"))
      out += c["kd_s"].get<double>() * s /
             (1.0 + s / (2.0 * std::numbers::pi * c["derivative_corner_hz"].get<double>()));
    return out;
  }
  static Complex sections(const Json& file, Complex s) {
    Complex out = file["gain"].get<double>();
    for (const Json& section : file["sections"]) {
      out *= section["gain"].get<double>();
      for (const Json& z : section["zeros_rad_s"]) out *= s - Complex(z[0], z[1]);
      for (const Json& p : section["poles_rad_s"]) out /= s - Complex(p[0], p[1]);
    }
    return out;
  }
  Json file(const std::string& name) const { return parsed(read_file(folder_ / name)); }

 private:
  TemporaryFolder folder_;
};

TEST_F(TuneCommand, BandwidthAndMarginsAreThoseOfTheLoop) {
  const ProgramResult made = run("--kind pid --bandwidth-hz 200 --sections s.json --json");
  ASSERT_EQ(made.status, 0) << made.err;
  const Json summary = parsed(made.out), c = file("c.json");
  EXPECT_EQ(c["type"], "pid");
  EXPECT_EQ(summary["limits_met"], true);
  const auto loop = [&](double hz) {
    const Complex s(0.0, 2.0 * std::numbers::pi * hz);
    return pid(c, s) * plant(s);
  };
  EXPECT_NEAR(std::abs(loop(200.0)), 1.0, 1e-6);
  EXPECT_NEAR(summary["nominal"]["phase_margin_deg"].get<double>(),
              180.0 + std::arg(loop(200.0)) * 180.0 / std::numbers::pi, 0.01);
  double sensitivity = 0.0, turned = 0.0;
  for (double f = 1.0; f < 1e4; f *= 1.0005) {
    sensitivity = std::max(sensitivity, 1.0 / std::abs(1.0 + loop(f)));
    if (turned == 0.0 && loop(f * 1.0005).imag() > 0.0 && loop(f).imag() <= 0.0) turned = std::abs(loop(f));
  }
  EXPECT_NEAR(summary["nominal"]["max_sensitivity"].get<double>(), sensitivity, 2e-3 * sensitivity);
  EXPECT_NEAR(summary["nominal"]["gain_margin_db"].get<double>(), -20.0 * std::log10(turned), 0.02);
  EXPECT_GE(summary["worst"]["phase_margin_deg"].get<double>(), 60.0 - 1e-6);
  for (const double f : {3.0, 50.0, 2e3}) {
    const Complex s(0.0, 2.0 * std::numbers::pi * f);
    EXPECT_LT(std::abs(sections(file("s.json"), s) / pid(c, s) - 1.0), 1e-9) << f;
  }
}

/// Slow below a resonance, the loop's lowest corner is the derivative's, ten times the bandwidth: bode's own grid begins
/// well below the crossing, not at it, where last digits would decide whether it is one.
TEST_F(TuneCommand, BodeFindsTheMarginsWithoutBeingToldABand) {
  const Json bode = resonant_loop(3.0);
  EXPECT_LT(bode["band_hz"][0].get<double>(), 1.0);
  const Json crossings = bode["responses"][2]["margins"]["gain_crossings"];
  ASSERT_EQ(crossings.size(), 1u);
  EXPECT_NEAR(crossings[0]["frequency_hz"].get<double>(), 3.0, 1e-3);
}

TEST_F(TuneCommand, PlantsWithinTheTolerancesAreHeldToTheMargins) {
  const Json some =
      parsed(run("--kind pid --gain-tolerance-percent 20 --frequency-tolerance-percent 5 --json").out);
  const Json none = parsed(run("--kind pid --json").out);
  EXPECT_GT(some["plants"].size(), none["plants"].size());
  double least = 1e9;
  for (const Json& plant : some["plants"]) least = std::min(least, plant["phase_margin_deg"].get<double>());
  EXPECT_EQ(some["worst"]["phase_margin_deg"].get<double>(), least);
  EXPECT_LT(some["ki_per_s"].get<double>(), none["ki_per_s"].get<double>());
}

TEST_F(TuneCommand, WhatCannotBeHadIsSaidAndStatusOne) {
  const ProgramResult fast = run("--kind pid --bandwidth-hz 3000");
  EXPECT_EQ(fast.status, 1) << fast.out;
  EXPECT_THAT(fast.out, HasSubstr("NOT met"));
  EXPECT_THAT(fast.out, HasSubstr("these margins can be had with --bandwidth-hz"));
  for (const char* wrong : {"--kind pi", "--phase-margin-deg 180", "--max-sensitivity 1", "--sigmas 0"})
    EXPECT_EQ(run(wrong).status, 2) << wrong;
  EXPECT_EQ(run("--phase-margin-deg 30 --max-sensitivity 3").status, 0);
}

}  // namespace
}  // namespace bodesmith
