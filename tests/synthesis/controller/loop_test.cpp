#include "synthesis/controller/loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/controller/seed_controller.hpp"

namespace bodesmith::generator {
namespace {

using ::testing::HasSubstr;

TEST(Loop, TheGeneratorsGainIsKTimesTheSlopeOfD) {
  const DisturbanceCircuit& c = seed_controller();
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    for (const double v : {0.0, 0.4, 1.0}) {
      const LoopPoint point{branch, v, Hertz{100.0}, 1.0};
      const std::complex<double> t = generator_loop_gain(c, point, Hertz{100.0}.rad_s());
      const auto& a = c.disturbance.coefficients(branch);
      const double slope = a[0] + v * (2.0 * a[1] + v * 3.0 * a[2]);
      EXPECT_NEAR(t.real(), c.disturbance.rate_gain(branch, Hertz{100.0}) * slope, 5e-3) << v;  // E96
      EXPECT_NEAR(t.imag(), 0.0, 1e-3);
    }
  }
}

TEST(Loop, AtPartialStrokesItsGainIsKTimesGTimesTheSlopeOverTheStroke) {
  Disturbance d = seed_disturbance();
  d.amplitude.alpha = {0.25, 0.5, 1.0};
  d.amplitude.ascending = {0.19, 0.43, 1.0};
  d.amplitude.descending = {0.3, 0.65, 1.0};
  const DisturbanceCircuit c = make_controller(d);
  for (const auto branch : kBranches) {
    for (const double stroke : {0.25, 0.5, 1.0}) {
      const LoopPoint point{branch, 0.9 * stroke, Hertz{100.0}, 1.0, stroke};
      const auto& a = d.coefficients(branch);
      const double slope = a[0] + 0.9 * (2.0 * a[1] + 0.9 * 3.0 * a[2]);
      const double wanted =
          d.rate_gain(branch, Hertz{100.0}) * d.amplitude.at(branch, stroke) / stroke * slope;
      EXPECT_NEAR(generator_loop_gain(c, point, Hertz{100.0}.rad_s()).real(), wanted, 5e-3) << stroke;
    }
  }
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  // The descending loop at half the stroke is the steepest there is, between the least and the full one.
  const LoopStability loop = checked_loop_stability(c);
  EXPECT_NEAR(loop.greatest_gain, 1.17 * 1.3 * 0.3958, 0.01);
  EXPECT_NEAR(loop.ngspice->greatest_gain, loop.greatest_gain, 3e-3);
  EXPECT_LT(loop.ngspice->greatest_difference, 3e-3);
  EXPECT_NEAR(loop.ngspice->margin_deg, loop.margin_deg, 1.0);
}

TEST(Loop, NgspiceAndTheOwnNetworkAgree) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const LoopStability loop = checked_loop_stability(seed_controller());
  ASSERT_TRUE(loop.ngspice);
  // Below 1 at every frequency: stable whatever the phase.
  EXPECT_LT(loop.greatest_gain, 0.5);
  EXPECT_GT(loop.nearest, 0.5);
  for (const LoopAt& at : loop.at) {
    if (at.greatest_gain > 0.05) {
      EXPECT_GT(at.bandwidth.value, 1e6);
    }
  }
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
  DisturbanceCircuit bad = seed_controller();
  bad.opamp.output_resistance_ohm = 20e3;  // with the switch's capacitor behind it
  bad.opamp.gain_bandwidth = Hertz{50e6};
  const LoopStability loop = loop_stability(bad);
  EXPECT_LT(loop.margin_deg, kLeastMarginDeg);
  EXPECT_THAT(loop_warning(loop), HasSubstr("phase margin"));
  EXPECT_THROW(require_stable(loop, false), DesignError);
  require_stable(loop, true);
}

TEST(Loop, FormsWithoutALoopAndIdealOpAmps) {
  Options options(Form::self_fed);
  options.form = Form::two_pass;
  const auto two = make_controller(seed_disturbance(), options);
  EXPECT_EQ(loop_stability(two).greatest_gain, 0.0);
  EXPECT_GT(loop_stability(two).margin_deg, 45.0);
  options.opamp = schematic::OpAmpModel::ideal();
  EXPECT_TRUE(loop_stability(make_controller(seed_disturbance(), options)).at.empty());
}

}  // namespace
}  // namespace bodesmith::generator
