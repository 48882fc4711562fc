#include "lti/frequency_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/error.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// s^2/(s^2 + s w0/Q + w0^2) beside the same with another Q: their quotient at w0 is that of the Qs.
Complex resonance(Hertz f, double q) {
  const Complex s(0.0, f.value / 1234.5);
  return s * s / (s * s + s / q + 1.0);
}

TEST(JudgingGrid, MeetsTheErrorOfANarrowResonance) {
  for (const double q : {5.0, 50.0, 500.0}) {
    const auto response = [&](Hertz f) { return resonance(f, q); };
    const std::vector<Hertz> grid = judging_grid(response, {Hertz{10.0}, Hertz{1e5}}, 61);
    EXPECT_TRUE(std::is_sorted(grid.begin(), grid.end()));
    EXPECT_LT(grid.size(), 500u);
    double worst = 0.0;
    for (const Hertz f : grid)
      worst = std::max(worst, std::abs(20.0 * std::log10(std::abs(resonance(f, 1.05 * q) / response(f)))));
    EXPECT_NEAR(worst, 20.0 * std::log10(1.05), 0.01 * 20.0 * std::log10(1.05)) << q;
  }
}

TEST(JudgingGrid, LeavesAPlainResponseAndANotchAsTheyAre) {
  const auto lag = [](Hertz f) { return 1.0 / Complex(1.0, f.value / 1000.0); };
  EXPECT_EQ(judging_grid(lag, {Hertz{10.0}, Hertz{1e5}}, 121).size(), 121u);
  const auto notch = [](Hertz f) { return Complex(1.0 - f.value * f.value / 1e6, 0.0); };
  EXPECT_LT(judging_grid(notch, {Hertz{10.0}, Hertz{2e3}}, 61).size(), 250u);
}

TEST(LogGrid, HitsBothEndsAndRefusesEmptyBands) {
  const auto grid = log_grid({Hertz{1}, Hertz{100}}, 3);
  ASSERT_EQ(grid.size(), 3u);
  EXPECT_EQ(grid[0].value, 1.0);
  EXPECT_NEAR(grid[1].value, 10.0, 1e-12);
  EXPECT_EQ(grid[2].value, 100.0);
  EXPECT_THROW(log_grid({Hertz{0}, Hertz{1}}, 3), InputError);
  EXPECT_THROW(log_grid({Hertz{2}, Hertz{1}}, 3), InputError);
  EXPECT_THROW(log_grid({Hertz{1}, Hertz{2}}, 1), InputError);
}

}  // namespace
}  // namespace bodesmith
