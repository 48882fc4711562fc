// Small changes through a chain, against the chain run sample by sample.
#include "chain/local_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "chain/inverse.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

constexpr double kStepS = 1e-3;

std::vector<double> smooth_drive(std::size_t count, double start) {
  std::vector<double> u;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) * kStepS;
    u.push_back(start + 0.6 * (1.0 - std::cos(40.0 * t)) + 0.2 * std::sin(95.0 * t) * t);
  }
  return u;
}

/// The output of one system for a sampled input that is straight in between, from rest under the first or from zero.
std::vector<double> run(const SampledSystem& s, const std::vector<double>& u, bool from_rest) {
  const Eigen::Index n = s.phi.rows();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  if (from_rest && n > 0) {
    for (int i = 0; i < 100000; ++i) x = s.phi * x + (s.from + s.to) * u[0];
  }
  std::vector<double> y;
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (i > 0) x = s.phi * x + s.from * u[i - 1] + s.to * u[i];
    y.push_back(s.c.dot(x) + s.d * u[i]);
  }
  return y;
}

// x' = -a x + u from a straight line: closed forms of its integrals.
TEST(LocalChain, ASampledLagIsItsIntegral) {
  StateSpace lag;
  const double a = 200.0;
  lag.a = {-a};
  lag.b = {1.0};
  lag.c = {3.0};
  lag.d = 0.25;
  const SampledSystem s = sampled(lag, kStepS);
  const double decay = std::exp(-a * kStepS), both = (1.0 - decay) / a;
  const double to = (1.0 - (1.0 - decay) / (a * kStepS)) / a;
  EXPECT_NEAR(s.phi(0, 0), decay, 1e-15);
  EXPECT_NEAR(s.to(0), to, 1e-17);
  EXPECT_NEAR(s.from(0), both - to, 1e-17);
  EXPECT_EQ(s.c(0), 3.0);
  EXPECT_EQ(s.d, 0.25);
}

/// The change that makes what a known drive made is that drive: of systems with and without a direct path, and slopes.
void expect_recovered(std::size_t count, bool from_rest, bool varying) {
  const SampledSystem lag = sampled(pole_zero_kernel(1.5, INFINITY, 300.0), kStepS);
  const SampledSystem lead = sampled(pole_zero_kernel(0.8, 200.0, 500.0), kStepS);
  std::vector<double> slopes = {2.0};
  if (varying) {
    slopes.clear();
    for (std::size_t i = 0; i < count; ++i) slopes.push_back(2.0 + std::sin(0.01 * static_cast<double>(i)));
  }
  const std::vector<double> u = smooth_drive(count, from_rest ? 0.4 : 0.0);
  std::vector<double> y = run(lag, u, from_rest);
  for (std::size_t i = 0; i < count; ++i) y[i] *= slopes[std::min(i, slopes.size() - 1)];
  y = run(lead, y, from_rest);
  LocalChain chain(kStepS, count);
  if (varying)
    chain.add(std::vector<SampledSystem>(count, lag));  // one a step
  else
    chain.add(lag);
  chain.add(slopes);
  chain.add(lead);
  EXPECT_EQ(chain.order(), 2u);
  LocalGoal goal;
  goal.change = y;
  goal.weight.assign(count, 1.0);
  goal.drive.assign(count, 0.0);
  goal.smoothing = 1e-7;
  goal.from_rest = from_rest;
  const std::vector<double> found = chain.change_for(goal);
  ASSERT_EQ(found.size(), count);
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_NEAR(found[i], u[i], from_rest ? 1e-5 : 1e-4) << i << " of " << count;
}
TEST(LocalChain, FindsTheDriveFromRest) {
  expect_recovered(400, true, false);
}
TEST(LocalChain, FindsTheDriveFromZeroThroughSlopesThatVary) {
  expect_recovered(400, false, true);
}
TEST(LocalChain, FindsTheDriveOfARecordLongerThanAWindow) {
  expect_recovered(9500, true, true);
}

TEST(LocalChain, CurvatureIsThatOfTheWholeDrive) {
  // Only the first output matters: the change takes every bend out of the drive, which was at rest before.
  LocalChain chain(kStepS, 50);
  chain.add(std::vector<double>{1.0});
  LocalGoal goal;
  goal.change.assign(50, 0.5);
  goal.weight.assign(50, 0.0);
  goal.weight.front() = 1.0;
  goal.smoothing = 1.0;
  for (int i = 0; i < 50; ++i) goal.drive.push_back(1e-3 * i * i);
  const std::vector<double> change = chain.change_for(goal);
  for (std::size_t i = 0; i < 50; ++i) EXPECT_NEAR(goal.drive[i] + change[i], 0.5, 1e-6) << i;
}

TEST(LocalChain, LimitsAreKeptByHoldingTheNearest) {
  const std::size_t count = 200;
  LocalChain chain(kStepS, count);
  chain.add(std::vector<double>{2.0});
  LocalGoal goal;
  goal.gain = 2.0;
  goal.smoothing = 1e-6;
  goal.weight.assign(count, 1.0);
  goal.drive.assign(count, 0.1);
  for (std::size_t i = 0; i < count; ++i) goal.change.push_back(std::sin(0.05 * static_cast<double>(i)));
  goal.limits.upper = 0.4;
  goal.limits.lower = -0.2;
  const std::vector<double> change = chain.change_for(goal);
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_NEAR(0.1 + change[i], std::clamp(0.1 + 0.5 * goal.change[i], -0.2, 0.4), 2e-3) << i;
}

TEST(DriveLimits, AHeldSignalIsWithinThemAndStaysSo) {
  DriveLimits limits;
  limits.lower = -0.5;
  limits.upper = 0.8;
  limits.max_rate_per_s = 100.0;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> u;
  for (int i = 0; i < 300; ++i) u.push_back(normal(random));
  EXPECT_FALSE(limits.kept(u, kStepS));
  std::vector<double> held = u;
  limits.hold(held, kStepS);
  for (std::size_t i = 0; i < held.size(); ++i) {
    EXPECT_GE(held[i], -0.5);
    EXPECT_LE(held[i], 0.8);
    if (i > 0) {
      EXPECT_LE(std::abs(held[i] - held[i - 1]), 0.1 + 1e-12) << i;
    }
  }
  EXPECT_TRUE(limits.kept(held, kStepS));
  // Backwards, and upside down: the same signal backwards and upside down.
  std::vector<double> turned(u.rbegin(), u.rend());
  DriveLimits mirrored = limits;
  mirrored.lower = -0.8;
  mirrored.upper = 0.5;
  for (double& v : turned) v = -v;
  mirrored.hold(turned, kStepS);
  for (std::size_t i = 0; i < held.size(); ++i)
    EXPECT_NEAR(turned[held.size() - 1 - i], -held[i], 1e-12) << i;
  // A step that is too fast becomes a ramp about its middle.
  std::vector<double> step(21, 0.0);
  std::fill(step.begin() + 10, step.end(), 0.7);
  limits.hold(step, kStepS);
  EXPECT_NEAR(step[0], 0.0, 1e-12);
  EXPECT_NEAR(step[20], 0.7, 1e-12);
  EXPECT_NEAR(step[9] + step[10], 0.7, 1e-12);
  EXPECT_FALSE(DriveLimits().any());
  EXPECT_TRUE(limits.any());
}

TEST(LinearInverse, IsTheDriveThatMakesTheOutput) {
  LinearKernel lag = pole_zero_kernel(2.0, INFINITY, 300.0);
  lag.offset = 0.3;
  lag.delay_s = 3.0 * kStepS;
  const std::vector<double> u = smooth_drive(300, 0.2);
  std::vector<double> y = run(sampled(lag, kStepS), u, true);
  for (double& v : y) v += 0.3;
  // Delayed by three samples, which the inverse makes good by looking ahead.
  std::vector<double> late(y.size(), y.front());
  for (std::size_t i = 3; i < y.size(); ++i) late[i] = y[i - 3];
  const FoundInput found = inverse_of(lag, {0.0, kStepS, late, true, 1e-7});
  for (std::size_t i = 0; i + 10 < u.size(); ++i) EXPECT_NEAR(found.values[i], u[i], 1e-4) << i;
  const FoundInput plain = inverse_of(gain_kernel(-4.0, 1.0), {0.0, kStepS, {1.0, 5.0}});
  EXPECT_EQ(plain.values, (std::vector<double>{-0.0, -1.0}));
}

}  // namespace
}  // namespace bodesmith::chain
