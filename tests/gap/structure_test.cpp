// Signs that what is left is more than noise.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "gap/signs.hpp"

namespace {

using namespace bodesmith::gap;

Leftover noise_of_colour(double memory, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Leftover l;
  l.step_s = 1e-3;
  double x = 0.0;
  for (int i = 0; i < 2000; ++i) {
    x = memory * x + normal(random);
    l.residual.push_back(x * std::sqrt(1.0 - memory * memory));
  }
  return l;
}

TEST(Signs, aChirpAndBurstsAreConcentratedAndNoiseIsNot) {
  auto chirp = noise_of_colour(0.0, 1);
  auto bursts = noise_of_colour(0.0, 2);
  for (std::size_t i = 0; i < 2000; ++i) {
    const double t = static_cast<double>(i) / 2000.0;
    chirp.residual[i] += 2.0 * std::sin(2.0 * std::numbers::pi * (40.0 + 250.0 * t) * t);
    for (double middle : {0.2, 0.55, 0.8})
      bursts.residual[i] +=
          6.0 * std::exp(-std::pow((t - middle) / 0.015, 2)) * std::sin(2.0 * std::numbers::pi * 300.0 * t);
  }
  EXPECT_TRUE(concentrated(chirp).found());
  EXPECT_TRUE(concentrated(bursts).found());
  for (unsigned seed = 10; seed < 30; ++seed) {
    EXPECT_FALSE(concentrated(noise_of_colour(0.0, seed)).found()) << seed;
    EXPECT_FALSE(concentrated(noise_of_colour(0.98, seed)).found()) << seed;
  }
}

TEST(Signs, aNarrowNotchStandsApartAndNoiseOfAnyLevelDoesNot) {
  const auto errors = [](unsigned seed, double rise) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Leftover l;
    for (int i = 0; i < 200; ++i) {
      for (int part = 0; part < 2; ++part) l.response.push_back(std::pow(rise, i / 200.0) * normal(random));
    }
    return l;
  };
  for (unsigned seed = 1; seed < 60; ++seed) EXPECT_FALSE(stands_apart(errors(seed, 30.0)).found()) << seed;
  auto notch = errors(1, 1.0);
  notch.response[160] += 25.0;
  EXPECT_TRUE(stands_apart(notch).found());
}

}  // namespace
