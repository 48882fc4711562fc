// The sideways error against its definition, tried at every frequency.
#include "lti/steep_flanks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// A notch: some 60 dB within a few percent.
Complex notch(double hz, double centre) {
  const Complex s(0.0, hz / centre);
  return (s * s + 2e-4 * s + 1.0) / (s * s + 0.7 * s + 1.0);
}

struct Tried {
  double neper = 1e300, rad = 1e300, relative = 1e300;
};

/// min over f' of the difference there and the way there, ln H straight in ln f between points.
Tried by_trying(const std::vector<Hertz>& grid, const std::vector<Complex>& wanted, std::size_t i,
                Complex got) {
  Tried out;
  constexpr int kParts = 400;
  const Complex log_got = std::log(got);
  double turn = 0.0;
  std::vector<double> angle = {std::arg(wanted[0])};
  for (std::size_t k = 1; k < wanted.size(); ++k) {
    turn = std::remainder(std::arg(wanted[k]) - std::arg(wanted[k - 1]), 2.0 * M_PI);
    angle.push_back(angle.back() + turn);
  }
  const double mine = angle[i] + std::remainder(log_got.imag() - angle[i], 2.0 * M_PI);
  for (std::size_t k = 0; k + 1 < grid.size(); ++k) {
    for (int part = 0; part <= kParts; ++part) {
      const double t = static_cast<double>(part) / kParts;
      const auto between = [&](double a, double b) { return a + t * (b - a); };
      const double log_f = between(std::log(grid[k].value), std::log(grid[k + 1].value));
      const double way = kFlankRate * std::abs(log_f - std::log(grid[i].value));
      const double level =
          log_got.real() - between(std::log(std::abs(wanted[k])), std::log(std::abs(wanted[k + 1])));
      const double phase = mine - between(angle[k], angle[k + 1]);
      out.neper = std::min(out.neper, way + std::abs(level));
      out.rad = std::min(out.rad, way + std::abs(phase));
      out.relative = std::min(out.relative, way + std::hypot(level, phase));
    }
  }
  return out;
}

TEST(SteepFlanks, TheErrorIsTheLeastOfAllShifts) {
  const std::vector<Hertz> grid = log_grid({Hertz{900.0}, Hertz{1100.0}}, 81);
  std::vector<Complex> wanted;
  for (const Hertz f : grid) wanted.push_back(notch(f.value, 1000.0));
  const FlankedCurve curve(grid, wanted);
  EXPECT_TRUE(curve.has_flanks());
  int steep = 0;
  // Too high, too low, and turned.
  for (const double centre : {997.0, 1004.0}) {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (!curve.is_judged(i)) continue;
      const Complex got = notch(grid[i].value, centre) * std::polar(1.02, 0.03);
      const FlankedCurve::Error error = curve.error(i, got);
      const double here = std::abs(std::log(std::abs(got / wanted[i])));
      const Tried tried = by_trying(grid, wanted, i, got);
      if (here > curve.as_it_is_below(i)) {
        constexpr double kTried = 6e-3;  // of a neper from one place tried to the next
        EXPECT_NEAR(error.neper, tried.neper, kTried) << grid[i].value;
        EXPECT_NEAR(error.rad, tried.rad, kTried) << grid[i].value;
        EXPECT_NEAR(error.relative, tried.relative, kTried + 0.1 * tried.relative) << grid[i].value;
        steep += error.neper < 0.5 * here ? 1 : 0;
      } else {
        EXPECT_NEAR(error.neper, here, 1e-12);
      }
    }
  }
  EXPECT_GT(steep, 5);
}

TEST(SteepFlanks, WhatIsFarBelowTheLargestIsNotJudged) {
  const std::vector<Hertz> grid = log_grid({Hertz{1.0}, Hertz{10.0}}, 5);
  for (const double scale : {1.0, 1e-6, 1e6}) {
    const std::vector<double> sizes = {0.3, 1.0, 1.01 * kJudgedFloor, 0.99 * kJudgedFloor, 0.0};
    std::vector<Complex> wanted;
    for (const double size : sizes) wanted.push_back(std::polar(scale * size, size));
    const FlankedCurve curve(grid, wanted);
    for (std::size_t i = 0; i < sizes.size(); ++i) EXPECT_EQ(curve.is_judged(i), i < 3) << i << " " << scale;
  }
}

TEST(SteepFlanks, WhereACurveIsFlatTheErrorIsTheDifference) {
  const std::vector<Hertz> grid = log_grid({Hertz{10.0}, Hertz{1000.0}}, 40);
  std::vector<Complex> wanted;
  for (const Hertz f : grid) wanted.push_back(1.0 / Complex(1.0, f.value / 100.0));
  const FlankedCurve curve(grid, wanted);
  EXPECT_FALSE(curve.has_flanks());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Complex got = wanted[i] * std::polar(1.3, -0.4);
    const FlankedCurve::Error error = curve.error(i, got);
    EXPECT_NEAR(error.neper, std::log(1.3), 1e-12);
    EXPECT_NEAR(error.rad, 0.4, 1e-12);
    EXPECT_NEAR(error.relative, std::abs(std::polar(1.3, -0.4) - 1.0), 1e-12);
  }
}

}  // namespace
}  // namespace bodesmith
