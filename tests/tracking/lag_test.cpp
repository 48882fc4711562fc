// The delay that fits best, against signals of which it is known.
#include "tracking/stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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
