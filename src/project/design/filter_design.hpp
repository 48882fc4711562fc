#pragma once

#include <optional>
#include <string>
#include <vector>

#include "approximate/approximate.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/direct/direct_fit.hpp"
#include "fpaa/plan/plan.hpp"
#include "project/design/design_stage.hpp"
#include "project/filter_project.hpp"
#include "project/limits.hpp"
#include "synthesis/realise_search.hpp"

namespace bodesmith::project {

/// A response from its target to its hardware, and what tolerances do to that.
struct FilterDesign {
  std::optional<CascadeFit> fit;                      ///< points that became a cascade
  std::optional<CascadeApproximation> approximation;  ///< of it
  std::optional<DirectFit> direct;  ///< points or a fractional transfer that became sections
  std::string how;                  ///< a sentence: what was made of the target, and why that
  Sections sections;
  std::optional<fpaa::Plan> plan;
  std::string no_plan;  ///< why not, where a board was asked for
  std::optional<synthesis::BuildChoice> circuit;
  std::optional<tolerance::Result> yield;
  std::vector<std::string> not_tried;  ///< in the time given
  double compute_s = 0.0;

  /// Largest |error| of the sections at the points, or against the target over its band, dB.
  double target_db = 0.0;
};

// Its stages. What the project does not ask for is left out; a DesignError is thrown for what cannot be made, but for a
// board's refusal, which stands in the design.
void add_sections(const FilterProject& project, FilterDesign& design);
void add_plan(const FilterProject& project, FilterDesign& design);
void add_circuit(const FilterProject& project, FilterDesign& design);
void add_tolerances(const FilterProject& project, FilterDesign& design);

/// Cascade (where there is one), sections, board as it runs, circuit as built. They refer to `design`.
std::vector<DesignStage> filter_stages(const FilterDesign& design);

std::vector<LimitCheck> check_limits(const FilterProject& project, const FilterDesign& design);

}  // namespace bodesmith::project
