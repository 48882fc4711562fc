#include "fpaa/plan/plan_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "fpaa/seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

TEST(PlanLimits, StepAndSineOfALowPass) {
  Sections sections;
  Section low;
  low.gain = 5.0 * 200.0;
  low.poles = {-200.0};
  sections.sections = {low};
  const Plan plan = plan_of(sections);
  // Gain 5 at DC: 3 V behind .6 V.
  EXPECT_NEAR(plan.max_input_v, 0.6, 0.02);
  EXPECT_NEAR(plan.max_step_v, 0.6, 0.03);
}

/// A clock of 2 kHz puts one line of each sine of the band to 1.5 kHz there: at 2 kHz less its frequency, for those above 500 Hz.
TEST(PlanLimits, ImagesOfAPlanAreTheRmsOverSinesOfTheBand) {
  Sections sections;
  sections.sections = {Section::pole_zero(1.0, {2000.0}, {500.0})};
  PlanOptions options;
  options.clock = Hertz{2000.0};
  options.band = Band{{1.0}, {1500.0}};
  const Plan plan = plan_of(sections, options);
  const SwitchedBoard board(plan);
  double squares = 0.0;
  const auto sines = log_grid(*options.band, 4000);
  for (const Hertz f : sines) {
    const RadPerSecond line[] = {Hertz{f.value - 2000.0}.rad_s()};
    if (f.value < 500.0) continue;
    squares += std::norm(board.components(f.rad_s(), line)[0] / sections.response(f.rad_s()));
  }
  EXPECT_GT(squares, 0.0);
  const double wanted = 100.0 * std::sqrt(squares / static_cast<double>(sines.size()));
  EXPECT_NEAR(plan.total->image_percent, wanted, 0.03 * wanted);
}

}  // namespace
}  // namespace bodesmith::fpaa
