#include "lti/level_and_phase.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.hpp"
#include "lti/bulk_response.hpp"

namespace bodesmith {
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
