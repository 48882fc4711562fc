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

TEST(NoiseFloor, PeriodsTellItAndOfADriveThatDoesNotRepeatWhatLiesAboveItsBand) {
  const auto residual = noise(4000, 0.1, 9), turns = sine(4000, 8, 1.0);
  auto input = noise(4000, 0.3, 10), repeated = turns;
  for (std::size_t i = 0; i < 4000; ++i) repeated[i] += turns[2 * i % 4000];
  const NoiseFloor floor = noise_floor(residual, repeated, 1e-3);
  EXPECT_EQ(floor.source, NoiseFloor::Source::periods);
  EXPECT_EQ(floor.period, 500u);
  EXPECT_NEAR(floor.rms, 0.1, 0.005);
  for (int pass = 0; pass < 30; ++pass) {
    for (std::size_t i = 1; i < input.size(); ++i) input[i] = 0.5 * (input[i] + input[i - 1]);
  }
  const NoiseFloor above = noise_floor(residual, input, 1e-3);
  EXPECT_EQ(above.source, NoiseFloor::Source::high_frequency);
  EXPECT_NEAR(above.rms, 0.1, 0.01);
  EXPECT_EQ(floor_from_periods(residual, 0).source, NoiseFloor::Source::unknown);
}

TEST(NoiseFloor, FromPeriodsIsTheNonRepeatingPart) {
  auto e = noise(8000, 0.1, 1);
  const auto odd = sine(8000, 4 * 3, 0.5);   // third harmonic of a period of 2000
  const auto even = sine(8000, 4 * 2, 0.2);  // second
  for (std::size_t i = 0; i < e.size(); ++i) e[i] += odd[i] + even[i];
  const auto floor = floor_from_periods(e, 2000);
  EXPECT_EQ(floor.periods, 4);
  EXPECT_NEAR(floor.rms, 0.1, 0.004);
  EXPECT_NEAR(floor.odd_rms, 0.5 / std::sqrt(2.0), 0.01);
  EXPECT_NEAR(floor.even_rms, 0.2 / std::sqrt(2.0), 0.01);
}

TEST(NoiseFloor, FromHighFrequenciesWhenTheInputLeavesThemFree) {
  const auto u = sine(6000, 40, 1.0);
  const auto floor = floor_from_high_frequencies(noise(6000, 0.3, 2), u, 1e-3);
  EXPECT_EQ(floor.source, NoiseFloor::Source::high_frequency);
  EXPECT_NEAR(floor.rms, 0.3, 0.03);
  EXPECT_EQ(floor_from_high_frequencies(noise(6000, 0.3, 2), noise(6000, 1.0, 3), 1e-3).source,
            NoiseFloor::Source::unknown);
}

// A tenth of 6000 samples is its memory: what stands over its level near half the sampling rate is its own rms.
TEST(NoiseFloor, HasRoomForNoiseOfTheLongestMemory) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    auto red = noise(6000, 0.3, seed);
    for (std::size_t i = 1; i < red.size(); ++i) red[i] += (1.0 - 1.0 / 600.0) * red[i - 1];
    const auto floor = floor_from_high_frequencies(red, sine(6000, 40, 1.0), 1e-3);
    EXPECT_GT(floor.most_noise, rms(red)) << seed;
    EXPECT_LT(floor.most_noise, 4.0 * rms(red)) << seed;
  }
}

TEST(Period, IsFoundOnlyWhereThereIsOne) {
  auto u = sine(6000, 8, 1.0);
  const auto more = sine(6000, 4, 0.5);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] += more[i];
  EXPECT_EQ(find_period(u), 1500U);
  EXPECT_EQ(find_period(noise(6000, 1.0, 4)), 0U);
}

TEST(Surrogate, KeepsTheSpectrumAndLosesThePhases) {
  const auto v = noise(4096, 1.0, 5);
  const auto s = phase_surrogate(v, 9);
  EXPECT_NEAR(rms(s), rms(v), 0.02);
  double along = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) along += v[i] * s[i];
  EXPECT_LT(std::abs(along) / (rms(v) * rms(s) * 4096.0), 0.08);
}

TEST(Where, FindsTheStretchOfADropOut) {
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
TEST(Where, TellsOutputsApartFromInputs) {
  bodesmith::TimeRecord record;
  record.step_s = 1e-3;
  record.u = noise(5000, 1.0, 9);
  record.y = sine(5000, 25, 1.0);
  auto e = noise(5000, 0.01, 10);
  for (std::size_t i = 0; i < e.size(); ++i) e[i] += std::max(0.0, record.y[i] - 0.8);
  const auto cells = where(record, e, 0, 0);
  const auto along = [&](Axis axis) {
    return std::find_if(cells.begin(), cells.end(), [&](const Cell& c) { return c.axis == axis; });
  };
  ASSERT_NE(along(Axis::output), cells.end());
  EXPECT_EQ(along(Axis::input), cells.end());
  EXPECT_GT(along(Axis::output)->from, 0.75);
  EXPECT_GT(along(Axis::output)->share, 0.9);
}

/// The cell of an axis, empty where that axis tells nothing.
Cell on(const std::vector<Cell>& cells, Axis axis) {
  const auto found = std::find_if(cells.begin(), cells.end(), [&](const Cell& c) { return c.axis == axis; });
  return found == cells.end() ? Cell{axis, NAN, NAN, 0.0, 0.0} : *found;
}

// A triangle of 100 samples a period: its way down, its ends, one harmonic of its period.
TEST(Where, NamesTheBranchTheAmplitudesAndTheHarmonic) {
  bodesmith::TimeRecord record;
  record.step_s = 1e-2;
  for (int i = 0; i < 2000; ++i)
    record.u.push_back(i % 100 < 50 ? i % 100 / 25.0 - 1.0 : 3.0 - i % 100 / 25.0);
  std::vector<double> falling(2000, 0.0), high(2000, 0.0), third(2000, 0.0);
  for (std::size_t i = 1; i < 2000; ++i) {
    falling[i] = record.u[i] < record.u[i - 1] ? 1.0 : 0.1;
    high[i] = record.u[i] > 0.7 ? 1.0 : 0.0;
    third[i] = std::sin(6.0 * std::numbers::pi * static_cast<double>(i) / 100.0);
  }
  const Cell down = on(where(record, falling, 0, 100), Axis::branch);
  EXPECT_EQ(down.from, -1.0);
  EXPECT_EQ(down.to, -1.0);
  EXPECT_NEAR(down.share, 1.0 / 1.01, 2e-3);
  EXPECT_NEAR(down.extent, 0.5, 2e-3);
  EXPECT_EQ(to_text(down), "while the input is falling (99 % of it)");
  const Cell top = on(where(record, high, 0, 100), Axis::input);
  EXPECT_NEAR(top.from, 0.7, 1e-9);
  EXPECT_NEAR(top.to, 1.0, 1e-9);
  EXPECT_NEAR(top.share, 1.0, 1e-9);
  EXPECT_NEAR(top.extent, 0.15, 0.02);
  const Cell harmonic = on(where(record, third, 0, 100), Axis::harmonic);
  EXPECT_EQ(harmonic.from, 3.0);
  EXPECT_EQ(harmonic.to, 3.0);
  EXPECT_NEAR(harmonic.extent, 1.0 / 51.0, 1e-9);
  // Counted from where the record settles, and in another unit, it is the same.
  for (double& u : record.u) u = 5.0 + 1e3 * u;
  EXPECT_NEAR(on(where(record, high, 500, 100), Axis::input).from, 5.0 + 1e3 * 0.7, 1e-6);
}

TEST(Where, OfAResponseIsWidenedUntilItHoldsHalf) {
  FrequencyRecord record;
  std::vector<double> residual;
  const std::vector<double> size = {0.1, 0.1, 1.5, 1.6, 0.1, 1.4, 0.1, 0.1};
  for (std::size_t i = 0; i < size.size(); ++i) {
    record.frequency.push_back(Hertz{10.0 * static_cast<double>(i + 1)});
    residual.push_back(0.6 * size[i]);
    residual.push_back(-0.8 * size[i]);
  }
  const std::vector<Cell> cells = where(record, residual);
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells[0].from, 30.0);
  EXPECT_EQ(cells[0].to, 60.0);
  EXPECT_NEAR(cells[0].extent, 0.5, 1e-12);
  EXPECT_NEAR(cells[0].share,
              (1.5 * 1.5 + 1.6 * 1.6 + 1.4 * 1.4 + 0.01) / (1.5 * 1.5 + 1.6 * 1.6 + 1.4 * 1.4 + 0.05), 1e-12);
}

TEST(Where, FindsTheFrequencyOfATone) {
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
