#include "fpaa/cams/filter_bilinear.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

TEST(FilterBilinear, PoleAndZeroIsABilinearImage) {
  const PoleZeroCapacitors c{7, 93, 5, 121};
  const Hertz clock{2000.0};
  const double zero = std::tan(std::numbers::pi * c.zero(clock).value / clock.value);
  const double pole = std::tan(std::numbers::pi * c.pole(clock).value / clock.value);
  for (const double f : {0.0, 1.0, 37.0, 400.0, 900.0}) {
    const Complex s(0.0, std::tan(std::numbers::pi * f / clock.value));
    const Complex analog = -c.dc_gain() * (1.0 + s / zero) / (1.0 + s / pole);
    const Complex sampled = c.transfer().response(Hertz{f}.rad_s(), clock);
    EXPECT_NEAR(std::abs(sampled - analog), 0.0, 1e-12) << f;
  }
  const Complex top = c.transfer().response(Hertz{1000.0}.rad_s(), clock);
  EXPECT_NEAR(top.real(), -c.high_frequency_gain(), 1e-12);
  EXPECT_DOUBLE_EQ(c.transfer().dc_gain(), -7.0 / 5.0);
  EXPECT_TRUE(c.transfer().is_stable());
}

TEST(FilterBilinear, CornerTurnsWhereTheTangentSays) {
  for (const double corner : {1.3, 20.0, 300.0, 480.0}) {
    const double ratio = 0.5 * (1.0 / std::tan(std::numbers::pi * corner / 2000.0) - 1.0);
    EXPECT_NEAR(branch_corner(1.0, ratio, {2000.0}).value, corner, 1e-9 * corner);
  }
  // Facts: the lowest pole is fc/1605.
  EXPECT_NEAR(2000.0 / branch_corner(1, 255, {2000.0}).value, 1605.0, 0.5);
}

TEST(ZTransfer, StabilityAgreesWithTheRoots) {
  EXPECT_TRUE((ZTransfer{{1.0}, {1.0, -0.99}}).is_stable());
  EXPECT_FALSE((ZTransfer{{1.0}, {1.0, -1.0}}).is_stable());
  // (1 - r e^{ja}/z)(1 - r e^{-ja}/z)
  for (const double r : {0.2, 0.999, 1.001, 3.0}) {
    EXPECT_EQ((ZTransfer{{1.0}, {1.0, -2.0 * r * std::cos(0.7), r * r}}).is_stable(), r < 1.0) << r;
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
