// Gaps that lie in one stretch of one axis: it is found there, with its share and extent.
#include "gap/report/where.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodesmith::gap {
namespace {

constexpr std::size_t kGapRows = 1000, kGapPeriod = 100;

/// Ten triangles from -1 to 1 and a slow ramp as output.
TimeRecord triangles() {
  TimeRecord out;
  out.step_s = 1e-3;
  out.start_s = 5.0;
  for (std::size_t i = 0; i < kGapRows; ++i) {
    const double phase = static_cast<double>(i % kGapPeriod) / kGapPeriod;
    out.u.push_back(phase < 0.5 ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase);
    out.y.push_back(static_cast<double>(i));
  }
  return out;
}

template <class Value>
std::vector<Cell> where_of(const Value& value, std::size_t from = 0, std::size_t period = 0) {
  std::vector<double> residual;
  for (std::size_t i = 0; i < kGapRows; ++i) residual.push_back(value(i));
  return where(triangles(), residual, from, period);
}

const Cell* find(const std::vector<Cell>& cells, Axis axis) {
  const auto at = std::ranges::find_if(cells, [&](const Cell& c) { return c.axis == axis; });
  return at == cells.end() ? nullptr : &*at;
}

/// Of equal size and of all frequencies.
double noisy(std::size_t i) {
  return (i * i * 7 + i / 3) % 2 == 0 ? 1.0 : -1.0;
}

TEST(Where, AGapLiesWhereItWasPut) {
  const auto times = where_of([](std::size_t i) { return i >= 400 && i < 500 ? noisy(i) : 0.0; });
  const Cell* time = find(times, Axis::time);
  ASSERT_NE(time, nullptr);
  EXPECT_NEAR(time->from, 5.4, 1e-3);
  EXPECT_NEAR(time->to, 5.499, 1e-3);
  EXPECT_EQ(time->share, 1.0);
  EXPECT_NEAR(time->extent, 0.1, 1e-12);
  // The output is a ramp: the same stretch.
  const Cell* output = find(times, Axis::output);
  ASSERT_NE(output, nullptr);
  EXPECT_NEAR(output->from, 0.4 * 999.0, 1e-9);
  EXPECT_LE(output->to, 0.55 * 999.0);
  EXPECT_EQ(find(times, Axis::branch), nullptr);  // as much as it is long
  EXPECT_EQ(to_text(*time), "times 5.4 to 5.5 s (100 % of it)");

  const auto sine =
      where_of([](std::size_t i) { return std::sin(2.0 * std::numbers::pi * 0.08 * double(i)); });
  ASSERT_FALSE(sine.empty());
  EXPECT_EQ(sine[0].axis, Axis::frequency);
  EXPECT_LT(sine[0].from, 80.0);
  EXPECT_GT(sine[0].to, 80.0);
  EXPECT_LT(sine[0].to - sine[0].from, 15.0);
  EXPECT_GT(sine[0].share, 0.9);
  EXPECT_LT(sine[0].extent, 0.03);
  EXPECT_EQ(find(sine, Axis::time), nullptr);

  const std::vector<double> u = triangles().u;
  const auto high = where_of([&](std::size_t i) { return u[i] > 0.81 ? noisy(i) : 0.0; });
  const Cell* input = find(high, Axis::input);
  ASSERT_NE(input, nullptr);
  EXPECT_NEAR(input->from, 0.8, 1e-9);
  EXPECT_NEAR(input->to, 1.0, 1e-9);
  EXPECT_EQ(input->share, 1.0);
  EXPECT_NEAR(input->extent, 0.11, 0.011);
  EXPECT_EQ(to_text(*input), "inputs from 0.8 to 1 (100 % of it)");

  for (const bool rising : {true, false}) {
    const auto cells =
        where_of([&](std::size_t i) { return i > 0 && (u[i] > u[i - 1]) == rising ? noisy(i) : 0.0; });
    const Cell* branch = find(cells, Axis::branch);
    ASSERT_NE(branch, nullptr);
    EXPECT_EQ(branch->from, rising ? 1.0 : -1.0);
    EXPECT_EQ(branch->to, branch->from);
    EXPECT_EQ(branch->share, 1.0);
    EXPECT_NEAR(branch->extent, 0.5, 2e-3);
    EXPECT_EQ(to_text(*branch), rising ? "while the input is rising (100 % of it)"
                                       : "while the input is falling (100 % of it)");
  }
}

TEST(Where, HarmonicsAreThoseOfThePeriodAndOnlyOfTwoAndMore) {
  const auto third = [](std::size_t i) { return std::cos(6.0 * std::numbers::pi * double(i) / kGapPeriod); };
  const auto cells = where_of(third, 0, kGapPeriod);
  const Cell* harmonic = find(cells, Axis::harmonic);
  ASSERT_NE(harmonic, nullptr);
  EXPECT_EQ(harmonic->from, 3.0);
  EXPECT_EQ(harmonic->to, 3.0);
  EXPECT_NEAR(harmonic->share, 1.0, 1e-12);
  EXPECT_NEAR(harmonic->extent, 1.0 / 51.0, 1e-12);
  EXPECT_EQ(find(where_of(third, 0, 0), Axis::harmonic), nullptr);
  EXPECT_EQ(find(where_of(third, 801, kGapPeriod), Axis::harmonic), nullptr);
  EXPECT_NE(find(where_of(third, 800, kGapPeriod), Axis::harmonic), nullptr);
}

TEST(Where, TheStartIsLeftOut) {
  const auto cells =
      where_of([](std::size_t i) { return i < 200               ? 100.0
                                          : i >= 600 && i < 696 ? noisy(i)
                                                                : 0.0; }, 200);
  const Cell* time = find(cells, Axis::time);
  ASSERT_NE(time, nullptr);
  EXPECT_NEAR(time->from, 5.6, 1e-3);
  EXPECT_NEAR(time->to, 5.719, 1e-3);
  EXPECT_NEAR(time->extent, 120.0 / 800.0, 1e-12);
  EXPECT_TRUE(where_of(noisy, kGapRows - 19).empty());
  EXPECT_FALSE(where_of(noisy, kGapRows - 20).empty());
}

// Two bursts of which neither holds half: the stretch grows until it does.
TEST(Where, AStretchHoldsHalfOfTheGapAtLeast) {
  const auto cells = where_of([](std::size_t i) {
    const bool burst = (i >= 100 && i < 120) || (i >= 500 && i < 520) || (i >= 900 && i < 920);
    return burst ? 3.0 * noisy(i) : 0.1 * noisy(i);
  });
  for (const Cell& one : cells) {
    EXPECT_GE(one.share, 0.5) << to_text(one);
    EXPECT_LE(one.share, 1.0);
    EXPECT_GT(one.extent, 0.0);
  }
  EXPECT_TRUE(
      std::ranges::is_sorted(cells, [](const Cell& a, const Cell& b) { return a.share > b.share + 1e-12; }));
}

TEST(Where, OfAResponseBetweenItsPoints) {
  FrequencyRecord record;
  std::vector<double> residual;
  for (int i = 1; i <= 20; ++i) {
    record.frequency.push_back(Hertz{10.0 * i});
    residual.push_back(i == 7 || i == 8 ? 3.0 : 0.1);
    residual.push_back(i == 7 || i == 8 ? -4.0 : 0.1);
  }
  const auto cells = where(record, residual);
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_EQ(cells[0].from, 70.0);
  EXPECT_EQ(cells[0].to, 80.0);
  EXPECT_NEAR(cells[0].share, 50.0 / (50.0 + 18.0 * 0.02), 1e-12);
  EXPECT_NEAR(cells[0].extent, 0.1, 1e-12);
  EXPECT_TRUE(where(FrequencyRecord(), {}).empty());
  EXPECT_EQ(to_text(cells[0]), "frequencies 70 to 80 Hz (99 % of it)");
}

// Bins lie side by side, from 0 on, and hold the whole mean square.
TEST(Where, FrequencyBinsHoldTheMeanSquare) {
  std::vector<double> e;
  for (std::size_t i = 0; i < 512; ++i) e.push_back(noisy(i) + std::sin(0.3 * double(i)));
  double mean = 0.0, square = 0.0, sum = 0.0, width = 0.0;
  for (const double v : e) mean += v / 512.0, square += v * v / 512.0;
  const Bins bins = frequency_bins(e, 1e-3);
  EXPECT_EQ(bins.front().from, 0.0);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    if (k > 0) {
      EXPECT_LE(bins[k - 1].to, bins[k].from * (1.0 + 1e-12));
    }
    if (bins[k].from > 100.0) {
      EXPECT_LT(bins[k].to / bins[k].from, 1.08);
    }
    sum += bins[k].energy;
    width += bins[k].extent;
  }
  EXPECT_GE(bins.back().to, 500.0 * (1.0 - 1e-9));
  EXPECT_NEAR(width, 502.0, 2.5);
  EXPECT_GT(sum, 0.3 * square);
}

}  // namespace
}  // namespace bodesmith::gap
