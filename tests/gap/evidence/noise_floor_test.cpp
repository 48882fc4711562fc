#include "gap/evidence/noise_floor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "gap/report/where.hpp"
#include "signal/period.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace {

using namespace bodesmith;
using namespace bodesmith::gap;

std::vector<double> noise(std::size_t n, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, size);
  std::vector<double> v(n);
  for (double& x : v) x = normal(random);
  return v;
}

std::vector<double> sine(std::size_t n, double cycles, double size) {
  std::vector<double> v(n);
  for (std::size_t i = 0; i < n; ++i)
    v[i] = size * std::sin(2 * std::numbers::pi * cycles * static_cast<double>(i) / static_cast<double>(n));
  return v;
}

TEST(NoiseFloor, fromPeriodsIsTheNonRepeatingPart) {
  auto e = noise(8000, 0.1, 1);
  const auto odd = sine(8000, 4 * 3, 0.5);   // third harmonic of a period of 2000
  const auto even = sine(8000, 4 * 2, 0.2);  // second
  for (std::size_t i = 0; i < e.size(); ++i) e[i] += odd[i] + even[i];
  const auto floor = floor_from_periods(e, 0, 2000);
  EXPECT_EQ(floor.periods, 4);
  EXPECT_NEAR(floor.rms, 0.1, 0.004);
  EXPECT_NEAR(floor.odd_rms, 0.5 / std::sqrt(2.0), 0.01);
  EXPECT_NEAR(floor.even_rms, 0.2 / std::sqrt(2.0), 0.01);
}

TEST(NoiseFloor, fromHighFrequenciesWhenTheInputLeavesThemFree) {
  const auto u = sine(6000, 40, 1.0);
  const auto floor = floor_from_high_frequencies(noise(6000, 0.3, 2), u, 1e-3);
  EXPECT_EQ(floor.source, NoiseFloor::Source::high_frequency);
  EXPECT_NEAR(floor.rms, 0.3, 0.03);
  EXPECT_EQ(floor_from_high_frequencies(noise(6000, 0.3, 2), noise(6000, 1.0, 3), 1e-3).source,
            NoiseFloor::Source::unknown);
}

TEST(Period, isFoundOnlyWhereThereIsOne) {
  auto u = sine(6000, 8, 1.0);
  const auto more = sine(6000, 4, 0.5);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] += more[i];
  EXPECT_EQ(find_period(u), 1500U);
  EXPECT_EQ(find_period(noise(6000, 1.0, 4)), 0U);
}

TEST(Surrogate, keepsTheSpectrumAndLosesThePhases) {
  const auto v = noise(4096, 1.0, 5);
  const auto s = phase_surrogate(v, 9);
  EXPECT_NEAR(rms(s), rms(v), 0.02);
  double along = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) along += v[i] * s[i];
  EXPECT_LT(std::abs(along) / (rms(v) * rms(s) * 4096.0), 0.08);
}

TEST(Where, findsTheStretchOfADropOut) {
  bodesmith::TimeRecord record;
  record.step_s = 1e-3;
  record.u = sine(5000, 25, 1.0);
  auto e = noise(5000, 0.01, 6);
  for (std::size_t i = 2000; i < 2200; ++i) e[i] += record.u[i];
  const auto cells = where(record, e, 0, 0);
  const auto time =
      std::find_if(cells.begin(), cells.end(), [](const Cell& c) { return c.axis == Axis::time; });
  ASSERT_NE(time, cells.end());
  EXPECT_GT(time->share, 0.9);
  EXPECT_NEAR(time->from, 2.0, 0.11);
  EXPECT_NEAR(time->to, 2.2, 0.11);
}

// A gap above an output of 0.8 that the input, faster and behind a delay, does not tell.
TEST(Where, tellsOutputsApartFromInputs) {
  bodesmith::TimeRecord record;
  record.step_s = 1e-3;
  record.u = noise(5000, 1.0, 9);
  record.y = sine(5000, 25, 1.0);
  auto e = noise(5000, 0.01, 10);
  for (std::size_t i = 0; i < e.size(); ++i) e[i] += std::max(0.0, record.y[i] - 0.8);
  const auto cells = where(record, e, 0, 0);
  const auto amplitude = [&](bool output) {
    return std::find_if(cells.begin(), cells.end(),
                        [&](const Cell& c) { return c.axis == Axis::amplitude && c.of_output == output; });
  };
  ASSERT_NE(amplitude(true), cells.end());
  EXPECT_EQ(amplitude(false), cells.end());
  EXPECT_GT(amplitude(true)->from, 0.75);
  EXPECT_GT(amplitude(true)->share, 0.9);
}

TEST(Where, findsTheFrequencyOfATone) {
  bodesmith::TimeRecord record;
  record.step_s = 1e-3;
  record.u = noise(5000, 1.0, 7);
  auto e = noise(5000, 0.05, 8);
  const auto tone = sine(5000, 5 * 173, 1.0);
  for (std::size_t i = 0; i < e.size(); ++i) e[i] += tone[i];
  const auto cells = where(record, e, 0, 0);
  ASSERT_FALSE(cells.empty());
  EXPECT_EQ(cells.front().axis, Axis::frequency);
  EXPECT_LT(cells.front().from, 173.0);
  EXPECT_GT(cells.front().to, 173.0);
  EXPECT_GT(cells.front().share, 0.9);
}

}  // namespace
