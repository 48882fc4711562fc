#include "signal/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace bodesmith {
namespace {

TEST(Statistics, QuantilesOfAFewNumbers) {
  const std::vector<double> v = {4.0, 1.0, 3.0, 2.0, 5.0};
  EXPECT_EQ(quantile(v, 0.0), 1.0);
  EXPECT_EQ(quantile(v, 0.5), 3.0);
  EXPECT_EQ(quantile(v, 1.0), 5.0);
  EXPECT_EQ(quantile({}, 0.5), 0.0);
  const std::vector<double> sorted = {1.0, 2.0, 4.0};
  EXPECT_EQ(quantile_of_sorted(sorted, 0.0), 1.0);
  EXPECT_EQ(quantile_of_sorted(sorted, 0.25), 1.5);
  EXPECT_EQ(quantile_of_sorted(sorted, 0.75), 3.0);
  EXPECT_EQ(quantile_of_sorted(sorted, 1.0), 4.0);
  EXPECT_EQ(quantile_of_sorted({}, 0.5), 0.0);
}

/// A one-pole process x[i] = a x[i-1] + e has the autocorrelation a^k: 1 + 2 sum a^k = (1 + a)/(1 - a).
TEST(Statistics, CorrelationTimeOfAnAutoregressiveProcess) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> white(40000), slow(40000);
  double x = 0.0;
  for (std::size_t i = 0; i < white.size(); ++i) {
    white[i] = normal(random);
    x = 0.8 * x + white[i];
    slow[i] = x;
  }
  EXPECT_NEAR(correlation_time(white), 1.0, 0.1);
  EXPECT_NEAR(correlation_time(slow), 9.0, 1.5);
}

/// The same improvement by chance alone is no more than a few deviations; one that takes a true part away is many.
TEST(Statistics, ImprovementIsToldFromChance) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  std::vector<double> noise(4000), with_part(4000), by_chance(4000);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    noise[i] = normal(random);
    with_part[i] = noise[i] + 0.3 * std::sin(0.05 * static_cast<double>(i));
    by_chance[i] = noise[i] - 0.01 * std::sin(0.031 * static_cast<double>(i));
  }
  EXPECT_GT(improvement_z(with_part, noise), 6.0);
  EXPECT_LT(improvement_z(noise, by_chance), 4.0);
}

}  // namespace
}  // namespace bodesmith
