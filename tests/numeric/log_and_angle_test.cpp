#include "numeric/log_and_angle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace bodesmith {
namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon();

TEST(LogAndAngle, LogarithmsAreWithinTwoUnitsOfThoseOfMoreDigits) {
  // From 1e-300 to 1e300, and closer and closer to 1 from both sides.
  for (double x = 1e-300; x < 1e300; x *= 1.00713) {
    const long double exact = std::log(static_cast<long double>(x));
    EXPECT_NEAR(log_of(x), static_cast<double>(exact), 2.0 * kUnit * std::abs(static_cast<double>(exact)))
        << x;
  }
  for (double off = 0.5; off > 1e-15; off *= 0.93) {
    for (const double x : {1.0 + off, 1.0 - off}) {
      const double exact = static_cast<double>(std::log(static_cast<long double>(x)));
      EXPECT_NEAR(log_of(x), exact, 2.0 * kUnit * std::abs(exact)) << x;
    }
  }
  EXPECT_EQ(log_of(1.0), 0.0);
  for (const double x : {0.0, 1e-310, HUGE_VAL, std::nan("")}) EXPECT_GT(std::abs(log_of(x)), 708.0) << x;
}

TEST(LogAndAngle, AnglesAreWithinTwoUnitsOfThoseOfMoreDigitsInEveryQuadrant) {
  for (double turn = -std::numbers::pi; turn < std::numbers::pi; turn += 1.7e-4) {
    for (const double size : {1e-150, 1.0, 1e150}) {
      const double x = size * std::cos(turn);
      const double y = size * std::sin(turn);
      const double exact =
          static_cast<double>(std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
      EXPECT_NEAR(angle_of(x, y), exact, 2.0 * kUnit * std::abs(exact)) << turn;
    }
  }
  // On the axes, from either side.
  for (const double y : {0.0, -0.0, 1.0, -1.0, 1e-300}) {
    for (const double x : {1.0, -1.0, 1e-300}) EXPECT_EQ(angle_of(x, y), std::atan2(y, x)) << x << " " << y;
  }
}

}  // namespace
}  // namespace bodesmith
