#include <gtest/gtest.h>

#include <string_view>

#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/generator/made_layout.hpp"
#include "synthesis/generator/ngspice_check.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::generator {
namespace {

TEST(DisturbanceLibrary, NgspiceMakesThePolynomialsAndFollowsATriangleUpTo5Kilohertz) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  Disturbance wanted;
  wanted.ascending = {0.3546, -0.6433, 0.2887};
  wanted.descending = {-0.2398, 0.0838, 0.156};
  const DisturbanceCircuit layout = make_layout(wanted);
  const DisturbanceCheck check = check_disturbance(layout, {Hertz{100}, Hertz{5000}});
  EXPECT_LT(check.static_percent, 0.04);
  EXPECT_LT(check.static_against_program, 5e-4);
  // The multipliers' errors at one deviation each, by the program and in ngspice.
  EXPECT_GT(check.off_percent, 0.15);
  EXPECT_LT(check.off_against_program, 5e-4);
  ASSERT_EQ(check.dynamic.size(), 2u);
  for (const DisturbanceCheck::Dynamic& one : check.dynamic) {
    // Late by a few per mille of a period at 100 Hz, by 6 microseconds at 5 kHz.
    const bool fast = one.frequency.value > 1000.0;
    EXPECT_LT(one.late_share, fast ? 0.035 : 0.004) << one.frequency.value << " Hz";
    EXPECT_LT(one.rms_percent, fast ? 0.2 : 0.02) << one.frequency.value << " Hz";
  }
  // Timing is what the program predicts.
  const generator::Timing timing = generator::make_timing(layout, {Hertz{5000}});
  const DisturbanceCheck::Dynamic& fast = check.dynamic.back();
  const double delay = timing.detector.delays[0].triangle_s.value();
  EXPECT_NEAR(fast.delay_s, delay, 0.05 * delay);
  const generator::SwitchFigures::Late& late = timing.analog_switch.late[0];
  EXPECT_NEAR(fast.rms_percent, late.rms_percent, 0.15 * late.rms_percent);
  EXPECT_NEAR(fast.rms_off_percent, late.rms_off_percent, 0.1 * late.rms_off_percent);
  ASSERT_TRUE(check.change.has_value());
  EXPECT_NEAR(check.change->delay_s, layout.analog_switch.on_delay_s, 10e-9);
  EXPECT_NEAR(check.change->glitch_percent, check.change->predicted_percent,
              0.25 * check.change->predicted_percent);
}

TEST(DisturbanceLibrary, EverySchemeOfDegreeSevenAndOneBranch) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const std::vector<double> seven = {0.3, -0.2, -0.2, 0.1, -0.1, 0.05, 0.05};
  for (const char* scheme : {"shared", "horner", "3"}) {
    generator::Options options;
    options.scheme = generator::Scheme::named(scheme);
    const bool moves = std::string_view(scheme) == "3";  // what follows the scheme is one circuit
    const DisturbanceCheck two =
        check_disturbance(layout_of({{"up", seven, {}}, {"down", {-0.2, 0.2}, {}}}, options),
                          moves ? std::vector{Hertz{5000}} : std::vector<Hertz>{});
    EXPECT_LT(two.static_against_program, 1e-3) << scheme;
    EXPECT_LT(two.off_against_program, 1e-3) << scheme;
    EXPECT_LT(two.static_percent, 0.1) << scheme;
    ASSERT_EQ(two.dynamic.size(), moves ? 1u : 0u) << scheme;
    if (moves) {
      EXPECT_LT(two.dynamic[0].rms_percent, 1.0);
    }
  }
  const DisturbanceCheck one = check_disturbance(layout_of({{"only", {0.1, -0.1, 0.2}, {}}}), {Hertz{100}});
  EXPECT_LT(one.static_against_program, 5e-4);
  EXPECT_TRUE(one.dynamic.empty());
}

TEST(DisturbanceLibrary, FiveBranchesBySelectLines) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  std::vector<generator::Polynomial> branches;
  for (int b = 1; b <= 5; ++b) branches.push_back({"b", {0.05 * b, -0.1, 0.02 * b}, {}});
  const DisturbanceCircuit layout = layout_of(branches);
  const DisturbanceCheck check = check_disturbance(layout, {Hertz{5000}});
  EXPECT_LT(check.static_against_program, 5e-4);
  EXPECT_LT(check.static_percent, 0.1);
  // The branches of the first pair differ by 7 % at the reversals.
  const double predicted = generator::make_timing(layout, {Hertz{5000}}).analog_switch.late[0].rms_percent;
  EXPECT_NEAR(check.dynamic[0].rms_percent, predicted, 0.15 * predicted);
  EXPECT_NEAR(check.change->glitch_percent, check.change->predicted_percent,
              0.35 * check.change->predicted_percent);
}

TEST(DisturbanceLibrary, AmplitudeGainsStaticAndAt5Kilohertz) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  Disturbance wanted;
  wanted.ascending = {0.3546, -0.6433, 0.2887};
  wanted.descending = {-0.2398, 0.0838, 0.156};
  wanted.amplitude.alpha = {0.1, 0.3, 1.0};
  wanted.amplitude.ascending = {0.1, 0.4, 1.0};
  wanted.amplitude.descending = {0.15, 0.25, 1.0};
  const DisturbanceCheck check = check_disturbance(make_layout(wanted), {Hertz{5000}});
  EXPECT_LT(check.static_percent, 0.15);
  EXPECT_LT(check.static_against_program, 0.02);
  EXPECT_LT(check.off_against_program, 0.02);
  ASSERT_EQ(check.dynamic.size(), 2u);
  EXPECT_EQ(check.dynamic[1].alpha, 0.3);
  EXPECT_LT(check.dynamic[1].rms_percent, 0.3);
}

}  // namespace
}  // namespace bodesmith::generator
