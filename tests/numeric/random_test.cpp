#include "numeric/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace bodesmith {
namespace {

TEST(Random, SplitMixGivesThePublishedWords) {
  // The first words for seed 1234567 of Vigna's splitmix64.c.
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317ULL);
  EXPECT_EQ(random.next(), 3203168211198807973ULL);
  EXPECT_EQ(random.next(), 9817491932198370423ULL);
}

TEST(Random, UniformNumbersStayWithinTheirInterval) {
  EXPECT_EQ(unit_interval(0), 0.0);
  EXPECT_LT(unit_interval(~0ULL), 1.0);
  EXPECT_GT(open_unit_interval(0), 0.0);
  EXPECT_LE(open_unit_interval(~0ULL), 1.0);
  Random random(3);
  for (int i = 0; i < 10000; ++i) EXPECT_LT(random.below(7), 7U);
}

void expect_standard_normal(const std::vector<double>& z) {
  double sum = 0.0, square = 0.0, fourth = 0.0;
  for (const double v : z) {
    sum += v;
    square += v * v;
    fourth += v * v * v * v;
  }
  const double n = static_cast<double>(z.size());
  // Five standard deviations of each moment's estimate.
  EXPECT_NEAR(sum / n, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(square / n, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / n, 3.0, 5.0 * std::sqrt(96.0 / n));
}

TEST(Random, NormalNumbersHaveTheMomentsOfTheNormalDistribution) {
  std::vector<double> in_turn, by_counter, by_quantile;
  Random random(17);
  for (std::uint64_t k = 0; k < 100000; ++k) {
    in_turn.push_back(random.normal());
    by_counter.push_back(normal_number(17, static_cast<std::int64_t>(k)));
    by_quantile.push_back(normal_quantile(uniform_pair(17, k, 0)[0]));
  }
  expect_standard_normal(in_turn);
  expect_standard_normal(by_counter);
  expect_standard_normal(by_quantile);
}

TEST(Random, ACounterBasedNumberDependsOnNothingElse) {
  const double third = normal_number(5, 3);
  normal_number(5, 4);
  EXPECT_EQ(normal_number(5, 3), third);
  EXPECT_NE(normal_number(6, 3), third);
  EXPECT_NE(normal_number(5, -3), third);
}

TEST(Random, PhiloxGivesThePublishedWords) {
  // Known answers of Random123 (kat_vectors, philox4x32 10).
  const std::array<std::uint32_t, 4> zeros{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8};
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), zeros);
  const std::array<std::uint32_t, 4> ones{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd};
  constexpr std::uint32_t f = 0xffffffff;
  EXPECT_EQ(philox({f, f, f, f}, {f, f}), ones);
}

TEST(Random, TheQuantileInvertsTheDistribution) {
  for (const double z : {-8.0, -5.5, -3.0, -1.2, -0.3, 0.0, 0.4, 1.5, 2.9}) {
    const double p = 0.5 * std::erfc(-z / std::sqrt(2.0));
    EXPECT_NEAR(normal_quantile(p), z, 1e-13 * (1.0 + std::abs(z))) << z;
  }
}

}  // namespace
}  // namespace bodesmith
