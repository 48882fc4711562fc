#include "fit/measured/measured_search.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// A lag and modes of damping 1e-4 to 0.03 over three decades.
ResponseSamples lag_and_modes(unsigned seed, int count, double noise) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share;
  std::normal_distribution<double> normal;
  std::vector<std::array<double, 3>> modes;  // w0, damping, height
  for (int k = 0; k < count; ++k) {
    const double w0 = std::pow(10.0, -2.8 + 2.7 * share(random));
    const double damping = std::pow(10.0, -4.0 + 2.5 * share(random));
    const double height = std::pow(10.0, -1.5 * share(random));
    modes.push_back({w0, damping, share(random) < 0.5 ? -height : height});
  }
  ResponseSamples out;
  for (int i = 0; i < 400; ++i) {
    const Complex s(0.0, std::pow(10.0, -3.0 + 3.0 * i / 399.0));
    Complex h = 1.0 / (1.0 + s / 0.03);
    for (const auto& [w0, damping, height] : modes)
      h += height * 2.0 * damping * w0 * w0 / (s * s + 2.0 * damping * w0 * s + w0 * w0);
    const double re = normal(random), im = normal(random);
    out.s.push_back(s);
    out.response.push_back(h + noise * std::sqrt(0.5) * Complex(re, im));
    out.deviation.push_back(noise);
  }
  return out;
}

// Started from evenly spread poles alone, or with new ones elsewhere, one narrow mode is missed: 484 and more.
TEST(MeasuredSearch, PolesAreAddedWhereTheErrorIsLargest) {
  const ResponseSamples samples = lag_and_modes(3, 8, 1e-4);
  MeasuredSearch search(samples, false);
  double before = INFINITY;
  for (int order = 1; order <= 17; ++order) {
    const double cost = search.of_order(order).cost;
    EXPECT_LT(cost, 1.001 * before) << order;
    before = cost;
  }
  EXPECT_LT(before, 420.0);  // of 400 points, each of mean 1
}

// Low modes lie close together on a linear axis: poles that begin there alone leave one out.
TEST(MeasuredSearch, AnOrderAskedForByItselfMeetsModesOverDecades) {
  for (const unsigned seed : {14u, 21u, 25u}) {
    const ResponseSamples samples = lag_and_modes(seed, 4, 1e-2);
    EXPECT_LT(MeasuredSearch(samples, false).of_order(9).cost, 450.0) << seed;  // of 400 points
  }
}

// Thirty turns of phase: from no delay on no search comes there.
TEST(MeasuredSearch, ADelayOfManyTurnsIsFound) {
  ResponseSamples samples;
  for (int i = 0; i < 200; ++i) {
    const Complex s(0.0, 0.005 * (i + 1));
    samples.s.push_back(s);
    samples.response.push_back(std::exp(-200.0 * s) / (1.0 + s / 0.3) + 1e-3 * std::polar(1.0, 2.4 * i * i));
    samples.deviation.push_back(1e-3);
  }
  const FactoredResponse found = MeasuredSearch(samples, true).of_order(1);
  EXPECT_NEAR(found.delay, 200.0, 0.01);
  EXPECT_LT(found.cost, 250.0);
}

}  // namespace
}  // namespace bodesmith
