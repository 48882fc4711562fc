#include "part_errors/loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "lti/frequency_grid.hpp"
#include "part_errors/loop_network.hpp"
#include "part_errors/margin.hpp"
#include "part_errors/seed_controller.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::part_errors {
namespace {

using ::testing::HasSubstr;

std::vector<std::complex<double>> on_grid(const std::vector<Hertz>& grid, double gain,
                                          const std::vector<double>& poles_hz) {
  std::vector<std::complex<double>> out;
  for (const Hertz f : grid) {
    std::complex<double> t = gain;
    for (const double pole : poles_hz) t /= std::complex<double>(1.0, f.value / pole);
    out.push_back(t);
  }
  return out;
}

TEST(Margin, OfLoopsInClosedForm) {
  const std::vector<Hertz> grid = log_grid({Hertz{0.01}, Hertz{1e6}}, 400);
  // An integrator and a pole at its crossing: 45 degrees there would be at |T| = 1/sqrt(2) of 1.
  const Margin two = phase_margin(grid, on_grid(grid, 1e5, {0.01, 1e3}));
  // |T| = 1e3/(f sqrt(1 + (f/1e3)^2)) = 1 at f = 786.15: 90 - atan(.78615) = 51.83 degrees.
  EXPECT_NEAR(two.deg, 51.83, 0.05);
  EXPECT_NEAR(two.crossing.value, 786.15, 2.0);
  // Three poles of 1 kHz with a gain above 8 oscillate; at 8 exactly the margin vanishes.
  EXPECT_LT(phase_margin(grid, on_grid(grid, 10.0, {1e3, 1e3, 1e3})).deg, 0.0);
  EXPECT_NEAR(phase_margin(grid, on_grid(grid, 8.0, {1e3, 1e3, 1e3})).deg, 0.0, 0.05);
  EXPECT_GT(phase_margin(grid, on_grid(grid, 6.0, {1e3, 1e3, 1e3})).deg, 0.0);
  EXPECT_NEAR(gain_margin_db(on_grid(grid, 4.0, {1e3, 1e3, 1e3})), 20.0 * std::log10(2.0), 0.03);
  EXPECT_EQ(phase_margin(grid, on_grid(grid, 0.4, {1e3})).deg, 180.0);
}

TEST(Loop, TheGeneratorsGainIsKTimesTheSlopeOfD) {
  const controller::AnalogController& c = seed_controller();
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    for (const double v : {0.0, 0.4, 1.0}) {
      const LoopPoint point{branch, v, Hertz{100.0}, 1.0};
      const std::complex<double> t = LoopNetwork(c, point).generator(Hertz{100.0}.rad_s());
      const auto& a = c.disturbance.coefficients(branch);
      const double slope = a[0] + v * (2.0 * a[1] + v * 3.0 * a[2]);
      EXPECT_NEAR(t.real(), c.disturbance.rate_gain(branch, Hertz{100.0}) * slope, 5e-3) << v;  // E96
      EXPECT_NEAR(t.imag(), 0.0, 1e-3);
    }
  }
}

TEST(Loop, NgspiceAndTheOwnNetworkAgree) {
  if (!spice::ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  const LoopStability loop = checked_loop_stability(seed_controller());
  ASSERT_TRUE(loop.ngspice);
  // Below 1 at every frequency: stable whatever the phase.
  EXPECT_LT(loop.greatest_gain, 0.5);
  EXPECT_NEAR(loop.ngspice->greatest_gain, loop.greatest_gain, 2e-3);
  EXPECT_LT(loop.ngspice->greatest_difference, 2e-3);
  EXPECT_GT(loop.margin_deg, 60.0);
  EXPECT_NEAR(loop.ngspice->margin_deg, loop.margin_deg, 0.5);
  EXPECT_NEAR(loop.ngspice->crossing.value / loop.crossing.value, 1.0, 0.02);
  ASSERT_TRUE(loop.ngspice->step);
  EXPECT_GT(loop.ngspice->step->step_percent, 5.0);
  EXPECT_LT(loop.ngspice->step->overshoot_percent, 1.0);
  EXPECT_LT(loop.ngspice->step->settled_s, 3e-6);
  EXPECT_EQ(loop_warning(loop), "");
  require_stable(loop, false);
}

TEST(Loop, ASlowHeavyOpAmpIsRefused) {
  controller::AnalogController bad = seed_controller();
  bad.opamp.output_resistance_ohm = 20e3;  // with the switch's capacitor behind it
  bad.opamp.gain_bandwidth = Hertz{50e6};
  const LoopStability loop = loop_stability(bad);
  EXPECT_LT(loop.margin_deg, kLeastMarginDeg);
  EXPECT_THAT(loop_warning(loop), HasSubstr("phase margin"));
  EXPECT_THROW(require_stable(loop, false), DesignError);
  require_stable(loop, true);
}

TEST(Loop, FormsWithoutALoopAndIdealOpAmps) {
  controller::Options options;
  options.form = controller::Form::two_pass;
  const auto two = controller::make_controller(seed_disturbance(), options);
  EXPECT_EQ(loop_stability(two).greatest_gain, 0.0);
  EXPECT_GT(loop_stability(two).margin_deg, 45.0);
  options.opamp = circuit::OpAmpModel::ideal();
  EXPECT_TRUE(loop_stability(controller::make_controller(seed_disturbance(), options)).at.empty());
}

}  // namespace
}  // namespace bodesmith::part_errors
