#include "fpaa/cams/filter_stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

TEST(FilterBilinear, PoleAndZeroIsABilinearImage) {
  const FilterStage c{.c = {7, 93, 5, 121}};
  const ZTransfer h = c.transfer();
  const Hertz clock{2000.0};
  const double zero = std::tan(std::numbers::pi * branch_corner(7, 93, clock).value / clock.value);
  const double pole = std::tan(std::numbers::pi * c.corner(clock).value / clock.value);
  for (const double f : {0.0, 1.0, 37.0, 400.0, 900.0}) {
    const Complex s(0.0, std::tan(std::numbers::pi * f / clock.value));
    const Complex analog = -c.gain() * (1.0 + s / zero) / (1.0 + s / pole);
    const Complex sampled = h.response(Hertz{f}.rad_s(), clock);
    EXPECT_NEAR(std::abs(sampled - analog), 0.0, 1e-12) << f;
  }
  const Complex top = h.response(Hertz{1000.0}.rad_s(), clock);
  EXPECT_NEAR(top.real(), -193.0 / 247.0, 1e-12);
  EXPECT_DOUBLE_EQ(h.dc_gain(), -7.0 / 5.0);
}

TEST(FilterBilinear, CornerTurnsWhereTheTangentSays) {
  for (const double corner : {1.3, 20.0, 300.0, 480.0}) {
    const double ratio = 0.5 * (1.0 / std::tan(std::numbers::pi * corner / 2000.0) - 1.0);
    EXPECT_NEAR(branch_corner(1.0, ratio, {2000.0}).value, corner, 1e-9 * corner);
  }
  // Facts: the lowest pole is fc/1605.
  EXPECT_NEAR(2000.0 / branch_corner(1, 255, {2000.0}).value, 1605.0, 0.5);
}

}  // namespace
}  // namespace bodesmith::fpaa
