#include "report/scale.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace bodesmith::report {
namespace {

TEST(Ticks, AreRoundAndCoverTheRange) {
  EXPECT_EQ(linear_ticks(0.0, 1.0, 5), (std::vector<double>{0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0}));
  EXPECT_EQ(logarithmic_ticks(1.0, 100.0), (std::vector<double>{1, 2, 5, 10, 20, 50, 100}));
  EXPECT_EQ(logarithmic_ticks(1.0, 1e4), (std::vector<double>{1, 10, 100, 1000, 10000}));
  EXPECT_TRUE(linear_ticks(1.0, 1.0, 5).empty());
}

// Of any range: inside it, evenly spaced, not far from as many as asked for, 1, 2 or 5 times a power of ten apart.
TEST(Ticks, LinearOnesKeepTheirLaw) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> from(-100.0, 100.0);
  std::uniform_real_distribution<double> log_span(
      -6.0, 9.0);  // below, the ends themselves are rounded too coarsely
  for (int i = 0; i < 500; ++i) {
    const double low = from(random);
    const double high = low + std::pow(10.0, log_span(random));
    const auto ticks = linear_ticks(low, high, 6);
    ASSERT_GE(ticks.size(), 2u) << low << " " << high;
    ASSERT_LE(ticks.size(), 13u) << low << " " << high;
    const double step = ticks[1] - ticks[0];
    const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
    EXPECT_TRUE(std::abs(mantissa - 1.0) < 1e-4 || std::abs(mantissa - 2.0) < 1e-4 ||
                std::abs(mantissa - 5.0) < 1e-4)
        << mantissa;
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      EXPECT_GE(ticks[k], low - 1e-6 * step);
      EXPECT_LE(ticks[k], high + 1e-6 * step);
      EXPECT_NEAR(ticks[k], ticks[0] + static_cast<double>(k) * step, 1e-4 * step);
    }
  }
}

TEST(Ticks, LogarithmicOnesAreInsideAndNeverCrowd) {
  for (double low = 1e-12; low < 1e6; low *= 7.3) {
    for (double ratio = 3.0; ratio < 1e30; ratio *= 11.0) {
      const auto ticks = logarithmic_ticks(low, low * ratio);
      EXPECT_LE(ticks.size(), 11u) << low << " " << ratio;
      for (std::size_t k = 0; k < ticks.size(); ++k) {
        EXPECT_GE(ticks[k], low * (1.0 - 1e-6));
        EXPECT_LE(ticks[k], low * ratio * (1.0 + 1e-6));
        if (k > 0) {
          EXPECT_GT(ticks[k], 1.9 * ticks[k - 1]);
        }
      }
    }
  }
}

TEST(Ticks, SubdivisionsAreBetweenDecades) {
  EXPECT_EQ(logarithmic_subdivisions(1.0, 10.0), (std::vector<double>{2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(logarithmic_subdivisions(35.0, 65.0), (std::vector<double>{40, 50, 60}));
}

TEST(Ticks, AreAtLeastFour) {
  for (const bool logarithmic : {false, true}) {
    for (double low = 0.13; low < 20.0; low *= 1.37) {
      for (double ratio = 1.05; ratio < 1e4; ratio *= 1.7) {
        const Scale scale{logarithmic, low, low * ratio, 0.0, 100.0};
        EXPECT_GE(scale.ticks(5).size(), 4u) << low << " " << ratio << " " << logarithmic;
      }
    }
  }
}

TEST(Ticks, AreWrittenShortly) {
  EXPECT_EQ(prefixed_tick_text(20000.0), "20k");
  EXPECT_EQ(prefixed_tick_text(1e6), "1M");
  EXPECT_EQ(prefixed_tick_text(0.5), "0.5");
  EXPECT_EQ(tick_text(0.0), "0");
  EXPECT_EQ(tick_text(0.6000000000000001), "0.6");
  EXPECT_EQ(tick_text(-250.0), "-250");
  EXPECT_EQ(tick_text(1e5), "1e5");
  EXPECT_EQ(tick_text(2.5e-4), "2.5e-4");
}

}  // namespace
}  // namespace bodesmith::report
