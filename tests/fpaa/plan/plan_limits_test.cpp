#include "fpaa/plan/plan_limits.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace bodesmith::fpaa
