#include "lti/bulk_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/units.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

Sections random_sections(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> decade(-2.0, 7.0), part(0.0, 1.0);
  Sections s;
  s.gain = -0.7;
  for (int i = 0; i < count; ++i) {
    const double w = std::pow(10.0, decade(random));
    Section one;
    one.gain = 0.5 + part(random);
    if (part(random) < 0.5) {
      one.poles = {-w};
      if (part(random) < 0.8) one.zeros = {part(random) < 0.1 ? 0.0 : -w * (0.3 + part(random))};
    } else {
      const double zeta = 0.05 + 0.9 * part(random);
      const Complex p = w * Complex(-zeta, std::sqrt(1.0 - zeta * zeta));
      one.poles = {p, std::conj(p)};
      if (part(random) < 0.7) one.zeros = {0.9 * p, 0.9 * std::conj(p)};
    }
    s.sections.push_back(one);
  }
  return s;
}

TEST(BulkResponse, AgreesWithTheSectionsOneByOne) {
  std::mt19937 random(3);
  for (const int count : {0, 1, 2, 3, 8, 16, 17, 60}) {
    Sections s = random_sections(random, count);
    if (count > 8) s.delay_s = 1e-7;
    const BulkResponse bulk(s);
    std::vector<RadPerSecond> w;
    for (double v = 1e-3; v < 1e9; v *= 1.37) w.push_back({v});
    std::vector<Complex> response(w.size());
    bulk.responses(w, response);
    for (std::size_t i = 0; i < w.size(); ++i) {
      const Complex wanted = s.response(w[i]);
      const double allowed = 1e-13 * (4 + count) * std::abs(wanted) + 1e-290;
      EXPECT_LT(std::abs(response[i] - wanted), allowed) << count << " at " << w[i].value;
    }
  }
}

// Sixty roots of 1e-12 rad/s or of 1e17 leave no trace of their size.
TEST(BulkResponse, DoesNotDependOnTheUnitOfTime) {
  std::mt19937 random(4);
  const Sections base = random_sections(random, 60);
  const std::vector<RadPerSecond> w = {{1e-3}, {0.2}, {30.0}, {4e3}, {5e6}};
  std::vector<Complex> wanted(w.size()), got(w.size());
  BulkResponse(base).responses(w, wanted);
  for (const double unit : {1e-10, 1e-3, 1e10}) {
    Sections other = base;
    std::vector<RadPerSecond> at = w;
    for (Section& one : other.sections) {
      for (auto* roots : {&one.zeros, &one.poles}) {
        for (Complex& root : *roots) root *= unit;
      }
      one.gain *=
          std::pow(unit, static_cast<double>(one.poles.size()) - static_cast<double>(one.zeros.size()));
    }
    for (RadPerSecond& one : at) one.value *= unit;
    BulkResponse(other).responses(at, got);
    for (std::size_t i = 0; i < w.size(); ++i)
      EXPECT_LT(std::abs(got[i] - wanted[i]), 1e-10 * std::abs(wanted[i])) << unit << " at " << w[i].value;
  }
}

}  // namespace

namespace {

TEST(LevelAndPhase, EightPolesRunTheirWholeTurnAndAgreeWithTheSections) {
  Sections sections;
  for (int i = 0; i < 8; ++i) sections.sections.push_back({1e3, {}, {-1e3 * std::pow(1.4, i)}});
  // Enough frequencies to be worked on in pieces.
  const std::vector<Hertz> grid = log_grid({Hertz{1.0}, Hertz{1e7}}, 40000);
  const auto h = responses(sections, grid);
  const LevelAndPhase curves = level_and_phase(h);
  for (std::size_t i = 0; i < grid.size(); i += 997) {
    const auto exact = sections.response(grid[i].rad_s());
    double phase = 0.0;
    for (const Section& s : sections.sections)
      phase -= to_degrees(std::atan(grid[i].rad_s().value / -s.poles[0].real()));
    EXPECT_NEAR(curves.magnitude_db[i], to_decibel(std::abs(exact)), 1e-10);
    EXPECT_NEAR(curves.phase_deg[i], phase, 1e-10);
  }
  EXPECT_LT(curves.phase_deg.back(), -719.0);
  const LevelAndPhase at_once = level_and_phase(sections, grid);
  EXPECT_EQ(at_once.magnitude_db, curves.magnitude_db);
  EXPECT_EQ(at_once.phase_deg, curves.phase_deg);
}

/// Eight poles turn by -720 degrees, a zero in the right half plane from 180 to 90; a notch on the axis as one just left of it.
TEST(LevelAndPhase, SectionsTurnAsTheirRootsDoHoweverCoarseTheGrid) {
  Sections sections;
  for (int i = 0; i < 8; ++i) sections.sections.push_back({1e3, {}, {-1e3 * std::pow(1.4, i)}});
  const double far = level_and_phase(sections, log_grid({Hertz{1e-3}, Hertz{1e9}}, 2)).phase_deg.back();
  EXPECT_NEAR(far, -720.0, 1e-3);
  sections.sections[0].zeros = {Complex(5e3)};
  EXPECT_NEAR(level_and_phase(sections, log_grid({Hertz{1e-3}, Hertz{1e9}}, 2)).phase_deg.back(), -630.0,
              1e-3);
  sections.sections[0] = {
      1.0, {Complex(0.0, 3e3), Complex(0.0, -3e3)}, {Complex(-300.0, 2e3), Complex(-300.0, -2e3)}};
  const LevelAndPhase fine = level_and_phase(sections, log_grid({Hertz{1.0}, Hertz{1e6}}, 3001));
  const LevelAndPhase coarse = level_and_phase(sections, log_grid({Hertz{1.0}, Hertz{1e6}}, 4));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(coarse.phase_deg[i], fine.phase_deg[1000 * i], 1e-9) << i;
}

TEST(LevelAndPhase, GainsBeyondTheRangeOfASquareKeepTheirLevel) {
  Sections sections;
  sections.gain = 1e-250;
  sections.sections.push_back({1.0, {-10.0}, {-20.0}});
  const std::vector<Hertz> grid = {Hertz{1.0}, Hertz{1e6}};
  const LevelAndPhase curves = level_and_phase(responses(sections, grid));
  EXPECT_NEAR(curves.magnitude_db[1], -5000.0, 1e-6);
  EXPECT_NEAR(curves.phase_deg[1], 0.0, 1e-3);
}

}  // namespace

}  // namespace bodesmith
