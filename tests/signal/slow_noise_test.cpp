#include "signal/red_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "signal/periodogram.hpp"

namespace {

constexpr int kSamples = 2000;

std::vector<double> white(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> v;
  for (int i = 0; i < kSamples; ++i) v.push_back(normal(random));
  return v;
}

/// White noise of a third of its size on top.
std::vector<double> red(double correlation_samples, unsigned seed) {
  const double memory = std::exp(-1.0 / correlation_samples);
  auto v = white(seed);
  const auto top = white(seed + 1000);
  double x = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    x = memory * x + std::sqrt(1.0 - memory * memory) * v[i];
    v[i] = x + 0.3 * top[i];
  }
  return v;
}

double deviations(const std::vector<double>& v) {
  return bodesmith::deviations_from_slow_noise(bodesmith::periodogram(v, 1e-3).power);
}

TEST(SlowNoise, whiteAndRedNoiseAreNearIt) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    EXPECT_LT(deviations(white(seed)), 5.0) << seed;
    for (double correlation : {5.0, 20.0, 120.0, 1000.0})
      EXPECT_LT(deviations(red(correlation, seed)), 5.0) << seed << " " << correlation;
  }
}

// 1/f: a lag in each octave.
TEST(SlowNoise, soIsNoiseOfOneOverF) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::vector<double> sum = white(seed + 500);
    for (double correlation = 2.0; correlation < 2000.0; correlation *= 2.0) {
      const double memory = std::exp(-1.0 / correlation);
      double x = 0.0;
      const auto drive = white(seed + 1000 + static_cast<unsigned>(correlation));
      for (std::size_t i = 0; i < sum.size(); ++i) {
        x = memory * x + std::sqrt(1.0 - memory * memory) * drive[i];
        sum[i] += 2.0 * x;
      }
    }
    EXPECT_LT(deviations(sum), 5.0) << seed;
  }
}

TEST(SlowNoise, aBandWithASteepEdgeAndALineAreFarFromIt) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto band = white(seed);
    auto line = white(seed);
    for (std::size_t i = 0; i < band.size(); ++i) {
      const double t = static_cast<double>(i) / kSamples;
      band[i] += 2.0 * std::sin(2.0 * std::numbers::pi * (5.0 + 40.0 * t) * t);  // sweeps to bin 85
      line[i] += 0.7 * std::sin(2.0 * std::numbers::pi * 150.0 * t);
    }
    EXPECT_GT(deviations(band), 8.0) << seed;
    EXPECT_GT(deviations(line), 8.0) << seed;
  }
}

// A deviance of 0 with n bands and three free values lies (n - 3)/sqrt(2 (n - 3)) below what chance leaves.
TEST(SlowNoise, aSpectrumThatAgreesToTheLastDigitIsBelowChance) {
  constexpr std::size_t kBins = 2000;
  int bands = 0;
  for (std::size_t k = 2; k < kBins; ++bands) k = std::min(kBins, std::max(k + 1, k * 5 / 4));
  const double freedom = bands - 3.0;
  EXPECT_NEAR(bodesmith::deviations_from_slow_noise(std::vector<double>(kBins, 7.0)),
              -std::sqrt(freedom / 2.0), 1e-6);
}

TEST(SlowNoise, ofNothingIsNothingSaid) {
  EXPECT_EQ(bodesmith::deviations_from_slow_noise({}), 0.0);
  EXPECT_EQ(deviations(std::vector<double>(kSamples, 0.0)), 0.0);
}

}  // namespace
