#include "numeric/grunwald_letnikov.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace bodesmith {
namespace {

TEST(GrunwaldLetnikov, WholeOrdersAreTheBackwardDifferences) {
  std::vector<double> weights(5, 0.0);
  add_difference_weights(2.0, 2.0, weights);
  EXPECT_EQ(weights, (std::vector<double>{2.0, -4.0, 2.0, 0.0, 0.0}));
  std::vector<double> sum(4, 0.0);
  add_difference_weights(1.0, -1.0, sum);  // the integral: all the past, alike
  EXPECT_EQ(sum, (std::vector<double>{1.0, 1.0, 1.0, 1.0}));
}

TEST(GrunwaldLetnikov, TheHalfDerivativeOfARampConvergesAtFirstOrder) {
  // D^(1/2) t = 2 sqrt(t/pi).
  double before = 0.0;
  for (const std::size_t n : {100U, 200U, 400U}) {
    const double h = 1.0 / static_cast<double>(n);
    std::vector<double> weights(n + 1, 0.0);
    add_difference_weights(std::pow(h, -0.5), 0.5, weights);
    std::vector<double> ramp(n + 1);
    for (std::size_t i = 0; i <= n; ++i) ramp[i] = h * static_cast<double>(i);
    const double error = std::abs(sum_over_past(weights, ramp, n) - 2.0 / std::sqrt(M_PI));
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 2.0, 0.05);
    }
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(GrunwaldLetnikov, SamplesAreJoinedByStraightLines) {
  const std::vector<double> samples = {1.0, 3.0, 2.0};
  EXPECT_EQ(straight_between(samples, 2), (std::vector<double>{1.0, 2.0, 3.0, 2.5, 2.0}));
  EXPECT_EQ(straight_between(samples, 1), samples);
  EXPECT_TRUE(straight_between({}, 3).empty());
}

}  // namespace
}  // namespace bodesmith
