#include "invert/local_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "chain/registry.hpp"

namespace bodesmith::invert {
namespace {

/// An operator that hardly answers but for one way: its slopes are held near that of the whole record, whatever the units.
TEST(LocalModel, WhatMostlyStandsStillHasTheSlopeOfItsRanges) {
  for (const double units : {1.0, 1e4}) {
    std::vector<std::vector<double>> signals(2);
    const auto add = [&](double u, double y) {
      signals[0].push_back(u);
      signals[1].push_back(units * y);
    };
    for (int i = 0; i < 40; ++i) add(i % 2 == 0 ? 0.0 : 0.1, i % 2 == 0 ? 0.0 : 1e-3);  // a hundredth of it
    for (int i = 1; i <= 10; ++i) add(0.1 * i, 0.1 * i);
    std::vector<chain::Kernel> blocks;
    blocks.push_back(chain::make_block("prandtl_ishlinskii")
                         .set("r", std::vector{0.0, 0.5})
                         .set("w", std::vector{1.0, 0.5})
                         .kernel());
    const double gain = local_model(blocks, signals, 1e-3).gain;
    EXPECT_GE(gain, 0.2 * units);
    EXPECT_LE(gain, 5.0 * units);
  }
}

/// Behind a delay, even one longer than the record, a block is that without the delay as long as its input is known, and then as it was last.
TEST(LocalModel, WhatIsBehindADelayIsMovedUp) {
  const std::size_t count = 60, from_rest = 20;
  const double step_s = 1e-3;
  for (const chain::Block& block :
       {chain::make_block("polynomial").set("coefficients", std::vector{0.0, 1.0, 0.4}),
        chain::make_block("resonator")
            .set("natural_frequency_hz", 80.0)
            .set("damping_ratio", 0.4)
            .set("cubic", 0.3)}) {
    const auto change = [&](double delay_s) {
      const auto late = static_cast<std::size_t>(std::lround(delay_s / step_s));
      std::vector<std::vector<double>> signals(3, std::vector<double>(count));
      for (std::size_t i = 0; i < count; ++i)
        signals[0][i] =
            1.0 + (i < from_rest ? 0.0 : 0.5 * std::sin(0.2 * static_cast<double>(i - from_rest)));
      for (std::size_t i = 0; i < count; ++i) signals[1][i] = signals[0][i < late ? 0 : i - late];
      signals[2] = signals[1];
      std::vector<chain::Kernel> blocks;
      blocks.push_back(chain::make_block("delay").set("delay_s", delay_s).kernel());
      blocks.push_back(block.kernel());
      const LocalModel model = local_model(blocks, signals, step_s);
      EXPECT_DOUBLE_EQ(model.delay_s, delay_s);
      chain::LocalGoal goal;
      goal.drive = signals[0];
      goal.weight.assign(count, 1.0);
      goal.smoothing = 1e-8;
      for (std::size_t i = 0; i < count; ++i)
        goal.change.push_back(1e-3 * std::sin(0.15 * static_cast<double>(i)));
      return model.chain.change_for(goal);
    };
    const std::vector<double> now = change(0.0);
    const std::vector<double> later = change(5.0 * step_s);
    const std::vector<double> beyond = change(1.5 * static_cast<double>(count) * step_s);
    for (std::size_t i = 0; i < count - 20; ++i)
      EXPECT_NEAR(later[i], now[i], 1e-8) << block.type().name() << i;
    for (std::size_t i = 0; i < from_rest - 10; ++i)
      EXPECT_NEAR(beyond[i], now[i], 1e-8) << block.type().name() << i;
  }
}

}  // namespace
}  // namespace bodesmith::invert
