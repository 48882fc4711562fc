#pragma once

#include <optional>
#include <string>

#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/layout.hpp"

namespace bodesmith::multiplier_layout {

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

}  // namespace bodesmith::multiplier_layout
