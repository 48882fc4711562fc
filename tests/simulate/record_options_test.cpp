// RecordOptions::max_parts: how long the record engine tries before it calls a run diverged.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "chain/registry.hpp"
#include "simulate/record_simulator.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Chain;
using chain::make_block;

/// 200 Hz, hardening so much that a period of the free spring is a small part of one of the linear one.
Chain wild(double cubic) {
  return {{make_block("resonator")
               .set("gain", 1.0)
               .set("natural_frequency_hz", 200.0)
               .set("damping_ratio", 0.02)
               .set("cubic", cubic)}};
}

std::vector<double> sine(std::size_t n) {
  std::vector<double> u(n);
  for (std::size_t i = 0; i < n; ++i) u[i] = std::sin(2.0 * std::numbers::pi * 0.01 * static_cast<double>(i));
  return u;
}

RecordSimulator simulator(const Chain& chain, double max_parts) {
  RecordOptions options;
  options.max_parts = max_parts;
  return RecordSimulator(chain, 1e-3, options);
}

TEST(MostParts, AStiffSpringIsGivenUpOnlyWhenTheLimitIsLow) {
  const auto u = sine(20000);
  auto patient = simulator(wild(3e3), 64.0);
  const auto y = patient.run(u);
  EXPECT_FALSE(patient.diverged());
  double most = 0.0;
  for (const double v : y) most = std::max(most, std::abs(v));
  EXPECT_GT(most, 0.01);
  EXPECT_LT(most, 1.0);
  auto hasty = simulator(wild(3e3), 0.5);
  const auto cut = hasty.run(u);
  EXPECT_TRUE(hasty.diverged());
  for (const double v : cut) ASSERT_TRUE(std::isfinite(v));
}

TEST(MostParts, ALowLimitChangesNothingWhereItIsNotReached) {
  const auto u = sine(5000);
  auto patient = simulator(wild(0.1), 64.0);
  auto hasty = simulator(wild(0.1), 4.0);
  const auto a = patient.run(u);
  const auto b = hasty.run(u);
  EXPECT_FALSE(hasty.diverged());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]) << i;
}

TEST(MostParts, ARunawaySpringEndsAsDivergedAndFinite) {
  auto runaway = simulator(wild(-5.0), 2.0);
  const auto y = runaway.run(sine(5000));
  EXPECT_TRUE(runaway.diverged());
  for (const double v : y) ASSERT_TRUE(std::isfinite(v));
  // The same object works again with sound values.
  runaway.chain().blocks[0].set("cubic", 0.1);
  runaway.run(sine(5000));
  EXPECT_FALSE(runaway.diverged());
}

}  // namespace
}  // namespace bodesmith::simulate
