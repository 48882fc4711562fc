#pragma once

#include "fpaa/plan.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// First seed, eq. 21-24: eight pole-zero pairs. The last pole is printed 625.1; with it the section's DC
/// gain would be 1.043, so it is read as 652.1.
inline Sections seed_sections() {
  const double table[4][5] = {{0.918, 48.79, 14.8, 47.49, 13.99},
                              {1.885, 107.6, 63.68, 126.4, 102.2},
                              {0.318, 380.2, 221.6, 214.9, 124.8},
                              {2.628, 400.0, 365.6, 652.1, 589.4}};
  Sections out;
  for (const auto& row : table) {
    Section section;
    section.gain = row[0];
    section.zeros = {-row[1], -row[2]};
    section.poles = {-row[3], -row[4]};
    out.sections.push_back(section);
  }
  return out;
}

/// A plan that can be made.
inline Plan plan_of(const Sections& sections, const PlanOptions& options = {}) {
  return value_or_throw(make_plan(sections, options));
}

/// The seed's plan at 2 kHz.
inline const Plan& seed_plan() {
  static const Plan plan = [] {
    PlanOptions options;
    options.clock = Hertz{2000.0};
    return plan_of(seed_sections(), options);
  }();
  return plan;
}

}  // namespace bodesmith::fpaa
