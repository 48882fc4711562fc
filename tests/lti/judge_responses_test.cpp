#include "lti/judge_responses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "lti/bulk_response.hpp"

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

namespace {

Responses of(const Sections& sections) {
  return [sections](const std::vector<Hertz>& grid) { return responses(sections, grid); };
}

/// Corners in Hz; damping 0 of the zeros is a notch on the axis.
Sections biquad(double zero_hz, double zero_damping, double pole_hz, double pole_damping) {
  const auto pair = [](double hz, double damping) {
    const double w = Hertz{hz}.rad_s().value;
    const std::complex<double> root(-damping * w, w * std::sqrt(1.0 - damping * damping));
    return std::vector<std::complex<double>>{root, std::conj(root)};
  };
  Sections out;
  out.sections = {{1.0, pair(zero_hz, zero_damping), pair(pole_hz, pole_damping)}};
  return out;
}

ResponseDifference on_dense_grid(const Sections& got, const Sections& wanted, Band band) {
  const std::vector<Hertz> grid = log_grid(band, 400001);
  return compare_responses(grid, responses(got, grid), responses(wanted, grid));
}

TEST(JudgeResponses, FindsWhatADenseGridFinds) {
  const Band band{Hertz{10.0}, Hertz{10000.0}};
  const Sections wanted = biquad(400.0, 0.4, 700.0, 0.1);
  for (const double off : {1.001, 1.01, 1.03}) {
    const Sections got = biquad(400.0 / off, 0.4, 700.0 * off, 0.1);
    const ResponseDifference judged = judge_responses(of(got), of(wanted), band);
    const ResponseDifference dense = on_dense_grid(got, wanted, band);
    EXPECT_NEAR(judged.max_magnitude_db, dense.max_magnitude_db, 2e-4 * dense.max_magnitude_db) << off;
    EXPECT_NEAR(judged.max_phase_deg, dense.max_phase_deg, 2e-4 * dense.max_phase_deg) << off;
    EXPECT_NEAR(judged.max_complex_percent, dense.max_complex_percent, 2e-4 * dense.max_complex_percent)
        << off;
  }
}

TEST(JudgeResponses, SmoothCurvesAreComparedAtEachFrequency) {
  const Band band{Hertz{10.0}, Hertz{10000.0}};
  const Sections wanted = biquad(300.0, 0.8, 900.0, 0.7);
  const Sections got = biquad(310.0, 0.8, 900.0, 0.6);
  double level = 0.0;
  double angle = 0.0;
  for (const Hertz f : log_grid(band, 100001)) {
    const std::complex<double> ratio = got.response(f.rad_s()) / wanted.response(f.rad_s());
    level = std::max(level, std::abs(to_decibel(std::abs(ratio))));
    angle = std::max(angle, std::abs(to_degrees(std::arg(ratio))));
  }
  const ResponseDifference judged = judge_responses(of(got), of(wanted), band);
  EXPECT_NEAR(judged.max_magnitude_db, level, 1e-4 * level);
  EXPECT_NEAR(judged.max_phase_deg, angle, 1e-4 * angle);
  EXPECT_FALSE(has_flanks([&](Hertz f) { return wanted.response(f.rad_s()); }, band));
}

/// A whole response moved sideways by a share of a percent is off by as many decibels, however steep it is; what straight
/// lines between points cost is a part in thirty, and a tenth of a degree where the angle turns below the floor.
TEST(JudgeResponses, AMovedNotchIsOffByItsShift) {
  const Band band{Hertz{20.0}, Hertz{125.0}};
  const Sections wanted = biquad(50.0, 0.0, 50.0, 0.1);
  EXPECT_TRUE(has_flanks([&](Hertz f) { return wanted.response(f.rad_s()); }, band));
  for (const double percent : {0.05, 0.3, 1.0}) {
    const double by = std::exp(percent / 100.0);
    const Sections got = biquad(50.0 * by, 0.0, 50.0 * by, 0.1);
    const ResponseDifference judged = judge_responses(of(got), of(wanted), band);
    EXPECT_LE(judged.max_magnitude_db, 1.03 * percent) << percent;
    EXPECT_GE(judged.max_magnitude_db, 0.5 * percent) << percent;
    EXPECT_LE(judged.max_phase_deg, 1.03 * 6.6 * percent + 0.1) << percent;
  }
}

TEST(JudgeResponses, ANotchThatIsMissingIsSaid) {
  const Band band{Hertz{20.0}, Hertz{125.0}};
  const Sections wanted = biquad(50.0, 0.0, 50.0, 0.1);
  const Sections flat = biquad(50.0, 0.1, 50.0, 0.1);
  EXPECT_GT(judge_responses(of(flat), of(wanted), band).max_magnitude_db, 8.0);
}

}  // namespace

}  // namespace bodesmith
