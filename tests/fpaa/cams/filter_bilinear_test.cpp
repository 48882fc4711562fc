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

TEST(FilterBilinear, CornerAndRatioAreInverse) {
  for (const double corner : {1.3, 20.0, 300.0, 480.0}) {
    const double ratio = branch_ratio({corner}, {2000.0});
    EXPECT_NEAR(branch_corner(1.0, ratio, {2000.0}).value, corner, 1e-9 * corner);
  }
  // Facts: the lowest pole is fc/1605.
  EXPECT_NEAR(2000.0 / branch_corner(1, 255, {2000.0}).value, 1605.0, 0.5);
}

TEST(FilterBilinear, VendorsLowPassScanKeepsItsFormulas) {
  const Hertz clock{250e3};
  const LowPassCapacitors c = vendor_low_pass({5e3}, 2.0, clock);
  const double w = 2.0 * clock.value * std::tan(std::numbers::pi * 5e3 / clock.value);
  EXPECT_EQ(c.cout, std::lround(c.cint / (clock.value / w - 0.5)));
  EXPECT_EQ(c.cin, 2 * c.cout);
  EXPECT_NEAR(c.corner(clock).value, 5e3, 5.0);
  EXPECT_NEAR(c.transfer().dc_gain(), -2.0, 1e-12);
}

TEST(ZTransfer, StabilityAgreesWithTheRoots) {
  EXPECT_TRUE((ZTransfer{{1.0}, {1.0, -0.99}}).is_stable());
  EXPECT_FALSE((ZTransfer{{1.0}, {1.0, -1.0}}).is_stable());
  // (1 - r e^{ja}/z)(1 - r e^{-ja}/z)
  for (const double r : {0.2, 0.999, 1.001, 3.0}) {
    EXPECT_EQ((ZTransfer{{1.0}, {1.0, -2.0 * r * std::cos(0.7), r * r}}).is_stable(), r < 1.0) << r;
  }
}

TEST(ZTransfer, HoldIsTheMeanOverAPeriod) {
  // The mean of exp(-j w t) over one period, by Simpson.
  const Hertz clock{2000.0};
  for (const double f : {0.0, 10.0, 100.0, 730.0}) {
    const double w = Hertz{f}.rad_s().value;
    Complex sum = 0.0;
    const int n = 200;
    for (int i = 0; i <= n; ++i) {
      const double weight = (i == 0 || i == n) ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
      sum += weight * std::polar(1.0, -w * i / (n * clock.value));
    }
    sum /= 3.0 * n;
    EXPECT_NEAR(std::abs(zero_order_hold({w}, clock) - sum), 0.0, 1e-9) << f;
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
