#pragma once

#include "fpaa/plan/error_reference.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/search/design.hpp"
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

/// The seed's eight sections as one chain at 2 kHz with capacitors that do not hang on any search (.23 % off up to 100 Hz).
inline const Plan& seed_plan() {
  static const Plan plan = [] {
    const struct {
      const char* name;
      std::vector<double> c;  // Ca, Cb, Cc, Cd
    } stages[] = {{"Section1a", {1, 135, 1, 143}},   {"Section1b", {4, 161, 5, 206}},
                  {"Section2a", {7, 216, 8, 153}},   {"Section2b", {11, 198, 9, 138}},
                  {"Section3a", {11, 94, 12, 186}},  {"Section3b", {4, 19, 3, 26}},
                  {"Section4a", {36, 177, 40, 116}}, {"Section4b", {36, 160, 34, 86}}};
    Design design;
    for (const auto& s : stages) {
      DesignStage stage;
      stage.name = s.name;
      stage.divisor = 8000;
      stage.from = {static_cast<int>(design.stages.size()) - 1};
      stage.c = s.c;
      design.stages.push_back(stage);
    }
    Plan out = value_or_throw(plan_of_design(design, an231k04_quad4()));
    out.topology = "chain";
    state_figures(out, seed_sections(), judged_band(seed_sections()), {});
    return out;
  }();
  return plan;
}

}  // namespace bodesmith::fpaa
