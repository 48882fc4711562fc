#include "simulate/pid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace bodesmith::simulate {
namespace {

PidController controller() {
  PidController out;
  out.proportional = 0.7;
  out.integral_per_s = 20.0;
  out.derivative_s = 0.01;
  out.derivative_corner = Hertz{50.0};
  out.period_s = 1e-3;
  return out;
}

TEST(Pid, SampledIsTrapezesAndABackwardDifference) {
  const PidController c = controller();
  SampledPid pid(c);
  const double wd = 2.0 * std::numbers::pi * 50.0 * 1e-3;
  double integral = 0.0, derivative = 0.0, before = 0.0;
  for (int i = 0; i < 50; ++i) {
    const double e = std::sin(0.3 * i) + 0.2;
    if (i > 0) {
      integral += 20.0 * 1e-3 * 0.5 * (e + before);
      derivative = (derivative + 0.01 * wd / 1e-3 * (e - before)) / (1.0 + wd);
    }
    EXPECT_NEAR(pid.update(e), 0.7 * e + integral + derivative, 1e-12) << i;
    before = e;
  }
}

TEST(Pid, AtALimitTheIntegralWaits) {
  PidController c = controller();
  c.derivative_s = 0.0;
  c.upper = 1.0;
  c.lower = -0.5;
  SampledPid pid(c);
  for (int i = 0; i < 200; ++i) EXPECT_LE(pid.update(1.0), 1.0);
  // .7 and an integral of no more than .3 and a step of it: the first lesser error comes off the limit at once.
  const double off = pid.update(0.0);
  EXPECT_LE(off, 0.3 + 0.02);
  EXPECT_GT(off, 0.25);
  for (int i = 0; i < 200; ++i) EXPECT_GE(pid.update(-1.0), -0.5);
  const double low = pid.update(0.0);
  EXPECT_GE(low, 0.2 - 0.02 - 0.01);
  // Out of a limit it moves on.
  SampledPid back(c);
  for (int i = 0; i < 20; ++i) back.update(1.0);
  const double first = back.update(-0.01), second = back.update(-0.01);
  EXPECT_NEAR(second - first, -0.01 * 20.0 * 1e-3, 1e-12);
}

TEST(Pid, ContinuousIsTheSampledOneOfShortPeriods) {
  PidController c = controller();
  c.period_s = 1e-6;
  SampledPid sampled(c);
  double states[2] = {0.0, 0.0}, rates[2], before = 0.0;
  double largest = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double t = 1e-6 * i, e = std::sin(600.0 * t);
    const double u = continuous_control(c, e, states, rates);
    EXPECT_NEAR(u, sampled.update(e), 3e-3) << i;
    if (i > 1) {
      // Its slope is the difference of its values.
      const double slope = continuous_control_slope(c, 600.0 * std::cos(600.0 * t), rates);
      largest = std::max(largest, std::abs((u - before) / 1e-6 - slope));
    }
    before = u;
    for (int k = 0; k < 2; ++k) states[k] += 1e-6 * rates[k];
  }
  EXPECT_LT(largest, 5.0);  // of 600 * 4
  // The integral stops running into a limit, not out of it.
  c.upper = 0.5;
  c.lower = -2.0;
  states[0] = 5.0, states[1] = 1.0;
  EXPECT_EQ(continuous_control(c, 1.0, states, rates), 0.5);
  EXPECT_EQ(rates[0], 0.0);
  states[1] = -1.0;
  continuous_control(c, -1.0, states, rates);
  EXPECT_EQ(rates[0], -20.0);
  states[0] = -9.0;
  EXPECT_EQ(continuous_control(c, -1.0, states, rates), -2.0);
  EXPECT_EQ(rates[0], 0.0);
  c.derivative_s = 0.0;
  continuous_control(c, 1.0, states, rates);
  EXPECT_EQ(rates[1], 0.0);
  // Half-way within a millionth beyond a limit half of its rate is left.
  c.proportional = 0.0;
  states[0] = 0.5 + 1e-6;
  continuous_control(c, 1.0, states, rates);
  EXPECT_NEAR(rates[0], 10.0, 1e-6);
}

}  // namespace
}  // namespace bodesmith::simulate
