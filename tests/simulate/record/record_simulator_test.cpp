// RecordOptions: how long the record engine tries before it calls a run diverged (max_parts), and what it keeps of a run
// (same_input).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "chain/registry.hpp"
#include "simulate/record/record_simulator.hpp"

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

/// A curve, dynamics that are not linear, memory, a clock and a lag: every kind of stage.
Chain of_all_kinds() {
  return {{make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.1}),
           make_block("resonator")
               .set("gain", 1.5)
               .set("natural_frequency_hz", 40.0)
               .set("damping_ratio", 0.1)
               .set("cubic", 0.3),
           make_block("prandtl_ishlinskii")
               .set("r", std::vector<double>{0.0, 0.1, 0.3})
               .set("w", std::vector<double>{1.0, 0.2, 0.1}),
           make_block("sample_hold").set("clock_hz", 170.0), make_block("lowpass").set("corner_hz", 60.0)}};
}

void expect_same_bits(std::span<const double> got, std::span<const double> expected, int round) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i)
    ASSERT_EQ(got[i], expected[i]) << "round " << round << ", " << i;
}

TEST(SameInput, BringsTheBitsOfARunFromTheBeginning) {
  const auto u = sine(900);
  const auto other = sine(700);
  RecordOptions options;
  options.same_input = true;
  RecordSimulator again(of_all_kinds(), 1e-3, options);
  // Which value of which block changes before each run; the record changes in one of them.
  struct Change {
    std::size_t block;
    std::size_t parameter;
    double factor;
  };
  const Change changes[] = {{4, 0, 1.1}, {4, 0, 1.0 / 1.1}, {3, 0, 1.2}, {2, 4, 1.5}, {1, 1, 1.05},
                            {4, 0, 1.3}, {0, 2, 1.5},       {2, 5, 0.5}, {4, 0, 1.1}, {1, 2, 2.0}};
  int round = 0;
  for (const Change& change : changes) {
    const auto& input = round == 6 ? other : u;
    auto& parameters = again.chain().blocks[change.block].parameters();
    ASSERT_LT(change.parameter, parameters.size());
    parameters[change.parameter].value *= change.factor;
    const auto got = again.run(input);
    RecordSimulator afresh(again.chain(), 1e-3);
    expect_same_bits(got, afresh.run(input), round++);
  }
}

}  // namespace
}  // namespace bodesmith::simulate
