#include "signal/period.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace bodesmith {
namespace {

/// A triangle and a third of a sine beside it, which make it unlike itself half a period later.
std::vector<double> repeating(std::size_t n, double period, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double phase = std::fmod(static_cast<double>(i), period) / period;
    out.push_back(1.0 - std::abs(2.0 * phase - 1.0) + 0.3 * std::sin(6.0 * std::numbers::pi * phase) +
                  noise * normal(random));
  }
  return out;
}

// Lengths on both sides of a power of two, and a period that does not divide them.
TEST(FindPeriod, IsThatOfAMeasuredSignalAndNothingOfNoise) {
  for (const std::size_t n : {std::size_t{250}, std::size_t{256}, std::size_t{257}, std::size_t{1023}}) {
    EXPECT_EQ(find_period(repeating(n, 97.0, 0.0, 1)), 97u) << n;
    EXPECT_EQ(find_period(repeating(n, 97.0, 2e-3, 1)), 97u) << n;
    EXPECT_EQ(find_period(repeating(n, static_cast<double>(n), 0.3, 2)), 0u) << n;
  }
  // In whatever unit.
  for (const double unit : {1e-3, 1e3}) {
    std::vector<double> scaled = repeating(257, 97.0, 2e-3, 1);
    for (double& v : scaled) v *= unit;
    EXPECT_EQ(find_period(scaled), 97u) << unit;
  }
  EXPECT_EQ(find_period(repeating(150, 97.0, 0.0, 1)), 0u) << "less than two of them";
}

/// Two periods of noise, the second off by a share of the rms at every sample.
TEST(FindPeriod, TakesTwoPeriodsForEqualBelowThreePercentOfTheRms) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const double share : {0.029, 0.031}) {
    std::vector<double> v(200);
    for (std::size_t i = 0; i < 100; ++i) v[i] = normal(random);
    double square = 0.0;
    for (std::size_t i = 0; i < 100; ++i) square += v[i] * v[i] / 100.0;
    for (std::size_t i = 0; i < 100; ++i)
      v[100 + i] = v[i] + share * std::sqrt(square) * (i % 2 == 0 ? 1.0 : -1.0);
    EXPECT_EQ(find_period(v), share < 0.03 ? 100u : 0u) << share;
  }
}

TEST(FindRepetition, IsExactOrNone) {
  const std::vector<double> u = repeating(500, 50.0, 0.0, 1);
  ASSERT_TRUE(find_repetition(u));
  EXPECT_EQ(find_repetition(u)->samples, 50u);
  std::vector<double> off = u;
  off[333] += 1e-6;
  EXPECT_FALSE(find_repetition(off));
  EXPECT_FALSE(find_repetition(std::vector<double>(100, 2.0))) << "a constant";
  // From a fifth of the way up on a triangle is back where it began before it repeats.
  std::vector<double> triangle;
  for (int i = 10; i < 400; ++i) triangle.push_back(1.0 - std::abs((i % 50) / 25.0 - 1.0));
  ASSERT_TRUE(find_repetition(triangle));
  EXPECT_EQ(find_repetition(triangle)->samples, 50u);
}

TEST(RepetitionOf, CountsWholeCycles) {
  const auto three = repetition_of(Hertz{3.0}, 1e-3, 2500);
  ASSERT_TRUE(three);
  EXPECT_EQ(three->samples, 1000u);
  EXPECT_EQ(three->cycles, 3u);
  EXPECT_FALSE(repetition_of(Hertz{3.0}, 1e-3, 900));
}

}  // namespace
}  // namespace bodesmith
