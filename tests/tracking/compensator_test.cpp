// What each kind of compensator is at one frequency.
#include "tracking/compensator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "base/error.hpp"
#include "tracking/model_stage.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::tracking {
namespace {

TEST(Compensator, AScheduledGainSettlesOnItsTable) {
  const ScheduledGain schedule{{Hertz{1.0}, Hertz{100.0}}, {1.0, 2.0}};
  const auto at = [&](double f) { return std::get<ConstantGain>(settled_at(schedule, Hertz{f})).gain; };
  EXPECT_DOUBLE_EQ(at(0.1), 1.0);
  EXPECT_DOUBLE_EQ(at(10.0), 1.5);
  EXPECT_DOUBLE_EQ(at(1e4), 2.0);
  EXPECT_DOUBLE_EQ(std::get<ConstantGain>(settled_at(ConstantGain{3.0}, Hertz{1.0})).gain, 3.0);
}

/// Linear in log f between the table's frequencies, its slope too.
TEST(Compensator, TheSlopeOfAScheduledGainIsItsDerivative) {
  const ScheduledGain schedule{{Hertz{1.0}, Hertz{10.0}, Hertz{100.0}}, {1.0, 2.0, 1.5}};
  for (const double f : {1.5, 9.0, 11.0, 70.0}) {
    EXPECT_NEAR(
        gain_slope_at(schedule, f),
        (gain_at(schedule, f * 1.0001) - gain_at(schedule, f / 1.0001)) / ((1.0001 - 1.0 / 1.0001) * f), 1e-6)
        << f;
  }
  EXPECT_EQ(gain_slope_at(schedule, 0.5), 0.0);
  EXPECT_EQ(gain_slope_at(schedule, 200.0), 0.0);
}

/// What a filter that is a gain alone lacks at each frequency is the rate gain less it, on either branch.
TEST(Compensator, WhatAGainLacksIsTheDifference) {
  Disturbance d;
  d.ascending = {0.4, -0.6, 0.2};
  d.descending = {-0.2, 0.1, 0.1};
  d.rate.frequency = {Hertz{1.0}, Hertz{30.0}};
  d.rate.ascending = {1.0, 1.2};
  d.rate.descending = {0.9, 1.4};
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    const ScheduledGain rest = rest_of(Sections{0.8, {}, std::nullopt}, d, branch);
    ASSERT_EQ(rest.frequency, d.rate.frequency);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_NEAR(rest.gain[i], d.rate_gain(branch, rest.frequency[i]) - 0.8, 1e-12);
  }
}

TEST(StagePaths, AResonanceIsItsEquationAtAnyDamping) {
  for (const double damping : {0.05, 0.999, 1.0, 3.0}) {
    const Sections path = resonance_path(Hertz{200.0}, damping);
    for (const double f : {1.0, 150.0, 3000.0}) {
      const std::complex<double> r(0.0, f / 200.0);
      EXPECT_LT(std::abs(path.response(Hertz{f}.rad_s()) * (1.0 + 2.0 * damping * r + r * r) - 1.0), 1e-12)
          << damping;
    }
  }
}

TEST(TrackingErrors, OfOneSampleThatIsOff) {
  std::vector<double> y = {0.0, 2.0, 4.0, 2.0, 0.0, 2.0, 4.0, 2.0};
  const std::vector<double> x(y.begin(), y.begin() + 4);
  y[5] = 1.5;
  const TrackingError error = plain_error(y, x);
  EXPECT_NEAR(error.max_percent, 100.0 * 0.5 / 4.0, 1e-12);
  EXPECT_NEAR(error.rms_percent, 100.0 * 0.5 / std::sqrt(8.0) / 4.0, 1e-12);
  EXPECT_THROW(plain_error({y.data(), 7}, x), InputError);
  EXPECT_THROW(plain_error(std::vector<double>(4, 1.0), x), InputError);
}

}  // namespace
}  // namespace bodesmith::tracking
