// State spaces against the responses of the sections they are made of, and at rest.
#include "lti/state_space.hpp"

#include <gtest/gtest.h>

namespace bodesmith {
namespace {

std::vector<Section> every_shape() {
  return {{2.3, {}, {}},
          {2.3, {}, {-3.0}},
          {2.3, {-5.0}, {-3.0}},
          {2.3, {}, {-3.0, -1e5}},
          {2.3, {-2.0}, {-3.0, -1e5}},
          {2.3, {-2.0, -9.0}, {-3.0, -4.0}},
          {2.3, {{-1.0, 7.0}, {-1.0, -7.0}}, {-3.0, -4.0}},
          {2.3, {}, {{-1.0, 9.0}, {-1.0, -9.0}}},
          {2.3, {0.0}, {{-1.0, 9.0}, {-1.0, -9.0}}},
          {2.3, {{-1.0, 7.0}, {-1.0, -7.0}}, {{-2.0, 9.0}, {-2.0, -9.0}}},
          {2.3, {4.0, -8.0}, {{-2.0, 9.0}, {-2.0, -9.0}}}};
}

TEST(StateSpace, RespondsAsItsSectionsDo) {
  Sections all;
  all.gain = 1.7;
  for (const Section& s : every_shape()) {
    all.sections.push_back(s);
    for (const double w : {0.0, 1.0, 9.0, 300.0, 1e6}) {
      const auto expected = s.response(RadPerSecond{w});
      EXPECT_LT(std::abs(response(state_space(s), {0.0, w}) - expected),
                1e-12 * std::max(1e-3, std::abs(expected)))
          << w;
    }
  }
  for (const double w : {0.0, 9.0, 300.0}) {
    const auto expected = all.response(RadPerSecond{w});
    EXPECT_LT(std::abs(response(state_space(all), {0.0, w}) - expected), 1e-10 * std::abs(expected) + 1e-12);
  }
}

TEST(StateSpace, StandsStillAtRestAndAnswersItsDcGain) {
  for (const Section& s : every_shape()) {
    StateSpace system = in_series(gain_system(0.5, 0.25), state_space(s));
    std::vector<double> x(system.order());
    std::vector<double> dx(system.order(), 1.0);
    equilibrium(system, 3.0, x.data());
    derivative(system, 3.0, x.data(), dx.data());
    for (const double rate : dx) EXPECT_NEAR(rate, 0.0, 1e-9);
    EXPECT_NEAR(output(system, 3.0, x.data()), s.dc_gain() * 1.75, 1e-9 * (1.0 + std::abs(s.dc_gain())));
  }
}

TEST(StateSpace, TheSlopeOfTheOutputIsItsRateOfChange) {
  const StateSpace system = state_space(Section{1.3, {-2.0, -9.0}, {-3.0, -4.0}});
  const double x[] = {0.3, -0.7};
  double dx[2];
  derivative(system, 0.4, x, dx);
  const double h = 1e-6;
  const double later[] = {x[0] + h * dx[0], x[1] + h * dx[1]};
  const double slope = (output(system, 0.4 + 0.2 * h, later) - output(system, 0.4, x)) / h;
  EXPECT_NEAR(output_slope(system, 0.2, dx), slope, 1e-7);
}

TEST(StateSpace, MaxRowSumOfNothingIsZero) {
  EXPECT_EQ(max_row_sum(gain_system(2.0)), 0.0);
  EXPECT_EQ(max_row_sum(state_space(Section{1.0, {}, {-3.0}})), 3.0);
}

}  // namespace
}  // namespace bodesmith
