#include "fpaa/charge_balance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "fpaa/cams/cam.hpp"
#include "stage_samples.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// So that the tests over stage_samples(), here and in ngspice, are over everything that has switches.
TEST(ChargeBalance, SamplesHoldEveryCamThatSaysItsSwitches) {
  std::set<std::string_view> sampled;
  for (const StageSample& sample : stage_samples()) sampled.insert(sample.cam.cam_name());
  EXPECT_GE(sampled.size(), 11u);
  for (const Cam* cam : cam_registry().all()) {
    if (sampled.count(cam->name()) > 0) continue;
    PlacedCam bare;
    bare.cam = cam;
    EXPECT_FALSE(cam->switches(bare).has_value()) << cam->name();
  }
}

/// The charge balance of every CAM's switches is its equation.
TEST(ChargeBalance, OfTheSwitchesIsTheEquationOfEveryStage) {
  for (const StageSample& sample : stage_samples()) {
    const PlacedCam& cam = sample.cam;
    const auto stage = cam.cam->switches(cam);
    ASSERT_TRUE(stage.has_value()) << sample.title;
    const OpAmpModel ideal{{2e3 * cam.clock_a.value}, 1e13};
    const ChargeBalance balance(*stage, ideal, cam.clock_a);
    for (const double share : {0.003, 0.05, 0.21, 0.4}) {
      const RadPerSecond w = Hertz{share * cam.clock_a.value}.rad_s();
      for (std::size_t i = 1; i <= cam.input_count(); ++i) {
        // A half-cycle delay shows a held input one period late.
        const Complex late = std::polar(1.0, -w.value / cam.clock_a.value * sample.late_periods.at(i - 1));
        const Complex wanted = cam.z_from(i).response(w, cam.clock_a) * late;
        const Complex got = balance.response(w, static_cast<int>(i));
        EXPECT_LT(std::abs(got / wanted - 1.0), 1e-7) << sample.title << ", input " << i;
      }
    }
  }
}

/// One op-amp, one step: what is left of the way is exp(-2 pi beta GBW t).
TEST(ChargeBalance, SlowOpAmpsLeaveTheClosedFormOfOneStep) {
  PlacedCam gain;
  gain.cam = cam_registry().find("GainHalf");
  gain.option = "Inverting";
  gain.clock_a = {1e6};
  gain.capacitors = {{"Cin", 30}, {"Cout", 10}};
  const OpAmpModel slow{{6e6}, 1e12};
  const ChargeBalance balance(*gain.cam->switches(gain), slow, gain.clock_a);
  // Reset to 0 in the other phase: every period is one step from (nearly) 0.
  const double in_reset = std::exp(-2.0 * std::numbers::pi * 6e6 * 0.5e-6);
  const double left = std::exp(-2.0 * std::numbers::pi * 0.25 * 6e6 * 0.5e-6);
  const Complex got = balance.response(Hertz{1e3}.rad_s());
  EXPECT_NEAR(std::abs(got), 3.0 * (1.0 - left), 3.0 * left * in_reset + 1e-4);
}

/// The same where the output is held: V = V_ideal + eps (V_before - V_ideal), and the charge that the switched
/// capacitors take away too much or too little comes back when the op-amp settles in phase 2.
TEST(ChargeBalance, SlowOpAmpsInAPoleZeroStageAreTheRecursion) {
  const double ca = 6.0, cb = 20.0, cc = 4.0, cd = 30.0, gbw = 4e6, clock = 1e6;
  PlacedCam cam;
  cam.cam = cam_registry().find("FilterBilinear");
  cam.option = "Pole and Zero";
  cam.clock_a = {clock};
  cam.capacitors = {{"Ca", 6}, {"Cb", 20}, {"Cc", 4}, {"Cd", 30}};
  const ChargeBalance balance(*cam.cam->switches(cam), {{gbw}, 1e12}, cam.clock_a);
  const double turns = 2.0 * std::numbers::pi * gbw * 0.5 / clock;
  const double beta1 = (cc + cd) / (ca + cb + cc + cd), beta2 = cd / (cb + cd);
  const double eps1 = std::exp(-beta1 * turns), eps2 = std::exp(-beta2 * turns);
  const double w = 0.05 * 2.0 * std::numbers::pi;  // of the clock
  double charge = 0.0, out2 = 0.0;                 // on the static capacitors; output at the end of phase 2
  double v2 = 0.0;                                 // inverting input there
  Complex sum = 0.0, reference = 0.0;
  for (int n = 0; n < 4000; ++n) {
    const double x = std::cos(w * n);
    const double ideal = -(charge + (ca + cb) * x) / (cc + cd);
    const double out1 = ideal + eps1 * (out2 - ideal);
    const double v1 = beta1 * (out1 - ideal);
    charge = (cb + cd) * v1 - cd * out1 - cb * x;  // of the junction, the switched ones taken away
    const double ideal2 = -(charge + cb * x) / cd;
    out2 = ideal2 + eps2 * (out1 - ideal2);
    v2 = beta2 * (out2 - ideal2);
    if (n < 2000) continue;
    sum += out1 * std::polar(1.0, -w * n);
    reference += x * std::polar(1.0, -w * n);
  }
  EXPECT_LT(std::abs(v2), 1.0);
  const Complex got = balance.response({w * clock});
  EXPECT_LT(std::abs(got - sum / reference), 1e-6);
  // And it is an error: without it the stage would make this.
  const Complex exact =
      cam.cam->transfers(cam, CapacitorUnits(cam.capacitors))[0].response({w * clock}, {clock});
  EXPECT_GT(std::abs(got / exact - 1.0), 1e-4);
}

}  // namespace
}  // namespace bodesmith::fpaa
