#include "invert/local_model.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace bodesmith::invert
