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

TEST(Statistics, RmsAndWhatIsLeftOfALine) {
  const std::vector<double> v = {3.0, -4.0, 0.0, 5.0};
  EXPECT_NEAR(rms(v), std::sqrt(50.0 / 4.0), 1e-15);
  EXPECT_EQ(rms({}), 0.0);
  // (i - 2)^2 - 2 is orthogonal to 1 and i on five places: it is what is left of itself and any line.
  std::vector<double> bent;
  for (int i = 0; i < 5; ++i) bent.push_back((i - 2.0) * (i - 2.0) - 2.0 + 7.0 - 1.5 * i);
  const std::vector<double> left = less_straight_line(bent);
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(left[static_cast<std::size_t>(i)], (i - 2.0) * (i - 2.0) - 2.0, 1e-14);
  EXPECT_EQ(less_straight_line({4.0}), std::vector<double>{0.0});
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

/// A ramp is like itself all along: its memory is followed up to a quarter of its length, and no more than that is said.
TEST(Statistics, ALongMemoryIsAQuarterOfTheLengthAtMost) {
  std::vector<double> ramp(400);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<double>(i);
  EXPECT_EQ(correlation_time(ramp), 100.0);
}

TEST(ErrorFigures, OfAnErrorOfPlusAndMinusOneAboutAnOffset) {
  std::vector<double> wanted, got;
  for (int i = 0; i < 100; ++i) {
    wanted.push_back(0.1 * i - 2.0);
    got.push_back(wanted.back() + 3.0 + (i % 2 == 0 ? 1.0 : -1.0));
  }
  const ErrorFigures figures = error_figures(got, wanted);
  EXPECT_NEAR(figures.rms, std::sqrt(10.0), 1e-12);
  EXPECT_NEAR(figures.rms_free_offset, 1.0, 1e-12);
  EXPECT_NEAR(figures.max, 4.0, 1e-12);
  EXPECT_NEAR(figures.range, 9.9, 1e-12);
  EXPECT_NEAR(figures.rms_percent, 100.0 * std::sqrt(10.0) / 9.9, 1e-10);
  EXPECT_NEAR(figures.max_percent, 400.0 / 9.9, 1e-10);
  // What is left out counts neither in the error nor in the range.
  got[0] = wanted[0] = 1e6;
  const ErrorFigures later = error_figures(got, wanted, 2);
  EXPECT_NEAR(later.rms, std::sqrt(10.0), 1e-12);
  EXPECT_NEAR(later.range, 9.7, 1e-12);
}

TEST(ErrorFigures, EveryRecordHasAnOffsetOfItsOwn) {
  const std::vector<double> flat = {1.0, 1.0, 1.0, 1.0};
  ErrorSum sum;
  sum.add(std::vector<double>{3.0, 3.0, 3.0, 3.0}, flat);
  sum.add(std::vector<double>{0.0, -2.0, 0.0, -2.0}, flat);
  const ErrorFigures figures = sum.figures();
  EXPECT_NEAR(figures.rms, std::sqrt((4 * 4.0 + 1.0 + 9.0 + 1.0 + 9.0) / 8.0), 1e-12);
  EXPECT_NEAR(figures.rms_free_offset, std::sqrt(4.0 / 8.0), 1e-12);
  EXPECT_EQ(figures.range, 0.0);
  EXPECT_EQ(figures.rms_percent, 0.0);
  EXPECT_EQ(error_figures({}, {}).rms, 0.0);
  // Of a record that ends before its first instant that counts, nothing does.
  for (const std::size_t first : {4u, 5u}) sum.add(std::vector<double>{9.0, 9.0, 9.0, 9.0}, flat, first);
  EXPECT_EQ(sum.figures().rms, figures.rms);
  EXPECT_EQ(sum.figures().rms_free_offset, figures.rms_free_offset);
}

}  // namespace

}  // namespace bodesmith
