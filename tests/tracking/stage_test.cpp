// The stage that reads its drive, against the figures worked out apart from the program (facts/tracking).
#include "tracking/stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/error.hpp"
#include "hysteresis/model_type.hpp"
#include "tracking/model_stage.hpp"
#include "tracking/reference.hpp"

namespace bodesmith::tracking {
namespace {

using Shape = Reference::Shape;

constexpr std::size_t kN = 8192;

Disturbance printed_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  return d;
}

std::vector<double> full_triangle(std::size_t n = kN) {
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double theta = static_cast<double>(i) / static_cast<double>(n);
    x[i] = theta < 0.5 ? 2.0 * theta : 2.0 - 2.0 * theta;
  }
  return x;
}

/// v = r - d(v) from v = r, so many times; branch by the slope of r.
std::vector<double> passes(int count) {
  const Disturbance d = printed_disturbance();
  const std::vector<double> r = full_triangle();
  std::vector<double> v = r;
  for (int k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < kN; ++i) {
      const auto branch = i < kN / 2 ? Disturbance::Branch::ascending : Disturbance::Branch::descending;
      v[i] = r[i] - d.value(branch, v[i]);
    }
  }
  return v;
}

double left_over(const Stage& stage, const std::vector<double>& v, DriveKind kind = DriveKind::smooth) {
  const double step = 1.0 / static_cast<double>(v.size());
  return tracking_error(stage.response(v, step, Hertz{1}, kind), full_triangle(v.size()), 1.0).rms_percent;
}

TEST(Stage, WhatIsLeftIsWhatTheFactsSay) {
  const PolynomialStage stage(printed_disturbance());
  EXPECT_NEAR(left_over(stage, passes(0)), 4.98, 0.01);
  EXPECT_NEAR(left_over(stage, passes(1)), 0.616, 0.001);
  EXPECT_NEAR(left_over(stage, passes(2)), 0.131, 0.001);
  EXPECT_NEAR(left_over(stage, passes(3)), 0.034, 0.001);
  EXPECT_LT(left_over(stage, passes(60)), 1e-10);
}

TEST(Stage, NestedLoopsAreTheSameOnTheFullStroke) {
  PolynomialStage::Options options;
  options.rule = PolynomialStage::Rule::nested;
  const PolynomialStage nested(printed_disturbance(), {}, options);
  EXPECT_NEAR(left_over(nested, passes(1)), 0.616, 0.002);
  EXPECT_LT(left_over(nested, passes(60)), 1e-3);
}

// A switch that is late by few samples: the drive goes back a little and then jumps, and the stage has turned where the drive did.
TEST(Stage, ALateSwitchCostsTheJumpForAsLongAsItIsLate) {
  Disturbance d;
  d.ascending = {0.0, 0.0, 0.0};
  d.descending = {0.0, -0.05, 0.0};
  constexpr std::size_t kLate = 20;
  std::vector<double> v = full_triangle();
  double sum = 0.0;  // of (d_d(v))^2 while it is late
  for (std::size_t i = kN / 2 + 1; i < kN; ++i) {
    if (i <= kN / 2 + kLate) {
      sum += std::pow(0.05 * v[i] * v[i], 2);
    } else {
      v[i] = (1.0 - std::sqrt(1.0 - 0.2 * v[i])) / 0.1;  // v - .05 v^2 = r
    }
  }
  const PolynomialStage stage(d);
  const double expected = 100.0 * std::sqrt(sum / kN);
  EXPECT_NEAR(left_over(stage, v), expected, 0.03 * expected);
  EXPECT_LT(left_over(stage, v, DriveKind::stepped), 0.3 * expected);
}

TEST(Stage, StepsOfAClockedDriveTurnNoBranch) {
  const PolynomialStage stage(printed_disturbance());
  std::vector<double> v = passes(60);
  for (std::size_t i = 0; i < kN; ++i) v[i] += 1e-3 * std::cos(0.7 * static_cast<double>(i));
  EXPECT_LT(left_over(stage, v, DriveKind::stepped), 0.12);
  EXPECT_GT(left_over(stage, v, DriveKind::stepped), 0.05);
}

TEST(Stage, SeveralPeriodsAreOneThatRepeats) {
  const PolynomialStage stage(printed_disturbance());
  const std::vector<double> one = passes(1);
  std::vector<double> three;
  for (int i = 0; i < 3; ++i) three.insert(three.end(), one.begin(), one.end());
  const double step = 0.1 / kN;
  const std::vector<double> y = stage.response(three, step, Hertz{10}, DriveKind::smooth),
                            alone = stage.response(one, step, Hertz{10}, DriveKind::smooth);
  ASSERT_EQ(y.size(), 3 * kN);
  for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(y[i], alone[i % kN], 1e-12) << i;
  EXPECT_THROW(stage.response(std::vector<double>(kN, NAN), step, Hertz{10}, DriveKind::smooth), InputError);
}

TEST(Stage, TheLagOfItsPathsIsFoundAndRemoved) {
  // A second-order path far above the reference is a delay 2 zeta/w.
  StagePaths paths;
  paths.mechanics.sections = {Section{1e10, {}, {{-5e4, 8.660254e4}, {-5e4, -8.660254e4}}}};
  const PolynomialStage stage(printed_disturbance(), paths);
  const std::vector<double> y = stage.response(passes(60), 0.01 / kN, Hertz{100}, DriveKind::smooth);
  const TrackingError error = tracking_error(y, full_triangle(), 0.01);
  EXPECT_NEAR(error.lag_s, 1e-5, 5e-8);
  EXPECT_NEAR(error.rms_percent, 100.0 * 2.0 * 100.0 * 1e-5, 0.01);
  EXPECT_LT(error.rms_percent_without_lag, 0.02);
  const TrackingError plain = plain_error(y, full_triangle());
  EXPECT_EQ(plain.rms_percent, error.rms_percent);
  EXPECT_EQ(plain.max_percent, error.max_percent);
}

TEST(Reference, TurnsWhereItSays) {
  for (const Shape shape : {Shape::triangle, Shape::sine, Shape::two_tone, Shape::decaying_triangle}) {
    const Reference r(shape, 0.5);
    double low = 1.0;
    double high = 0.0;
    for (std::size_t i = 0; i < 4000; ++i) {
      const double theta = (static_cast<double>(i) + 0.5) / 4000.0;
      const std::size_t piece = r.piece(theta);
      const double slope = (r.value(theta + 1e-7) - r.value(theta - 1e-7)) / 2e-7;
      EXPECT_NEAR(slope, r.slope(theta, piece), 1e-5) << to_string(shape);
      EXPECT_EQ(slope > 0.0, Reference::rises(piece)) << to_string(shape) << theta;
      low = std::min(low, r.value(theta));
      high = std::max(high, r.value(theta));
    }
    EXPECT_NEAR(low, 0.0, 1e-3) << to_string(shape);
    EXPECT_NEAR(high, 0.5, 1e-3) << to_string(shape);
    EXPECT_EQ(r.value(0.0), 0.0);
  }
}

TEST(Stage, AnotherFamilyTracksAsWellAsItFits) {
  for (const char* family : {"preisach", "prandtl_ishlinskii", "bouc_wen"}) {
    IdentifiedStage::Options options;
    options.samples = 40;
    options.identify.size = 20;
    const IdentifiedStage stage(hysteresis::model_type_registry().get(family), printed_disturbance(), {},
                                options);
    const double fit = stage.fit_percent(Hertz{1});
    EXPECT_NEAR(left_over(stage, passes(60)), fit, 0.5 * fit + 0.05) << family;
    EXPECT_GT(left_over(stage, passes(0)), 4.0) << family;
  }
}

}  // namespace
}  // namespace bodesmith::tracking

// The delay that fits best, against signals of which it is known.
namespace bodesmith::tracking {
namespace {

/// Two harmonics over one period of 2 s, `delay_s` later.
std::vector<double> two_harmonics(double delay_s) {
  std::vector<double> out;
  for (int i = 0; i < 256; ++i) {
    const double w = std::numbers::pi * (2.0 * i / 256.0 - delay_s);
    out.push_back(0.3 + std::cos(w) + 0.2 * std::sin(3.0 * w));
  }
  return out;
}

TEST(Lag, APureDelayIsFoundToRounding) {
  for (const double delay : {0.0, 0.0123, -0.07, 0.4}) {
    const LagResult got = best_lag(two_harmonics(delay), two_harmonics(0.0), 2.0);
    EXPECT_NEAR(got.lag_s, delay, 1e-12);
    EXPECT_NEAR(got.rms, 0.0, 1e-13);
  }
}

TEST(Lag, WhatNoDelayExplainsIsLeft) {
  std::vector<double> y = two_harmonics(0.05);
  for (double& v : y) v += 0.1;
  const LagResult got = best_lag(y, two_harmonics(0.0), 2.0);
  EXPECT_NEAR(got.lag_s, 0.05, 1e-12);
  EXPECT_NEAR(got.rms, 0.1, 1e-12);
}

}  // namespace
}  // namespace bodesmith::tracking
