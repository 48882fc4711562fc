#pragma once

#include <optional>
#include <string>

#include "base/documents/json_fwd.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/layout.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::generator {

/// layout.json without its header.
Json to_json(const Layout& layout);
/// Its part "budget".
Json to_json(const Budget& budget);
/// Its part "timing".
Json to_json(const Timing& timing);
/// The transient causes beside the budget at rest: percent of range while they last, s.
Json transient_budget_json(const Timing& timing);

struct DisturbanceLibrary {
  /// With the amplitude gains: `.subckt disturbance_amplitude x branch amplitude out`.
  bool amplitude = false;
  /// Every multiplier off by these limits (for checks).
  std::optional<ErrorLimits> errors;
};

/// `.subckt disturbance x branch out`; more than two branches have their select lines after `branch`. Beside
/// it, when there is a switch, `.subckt slope_detector x branch`.
std::string disturbance_library(const Layout& layout, const std::string& title,
                                const DisturbanceLibrary& options = {});

/// `x branch out`, or with select lines and amplitude.
std::string disturbance_pins(const Layout& layout, bool amplitude);

}  // namespace bodesmith::generator
