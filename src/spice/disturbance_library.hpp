#pragma once

#include <optional>
#include <string>

#include "multiplier_layout/budget.hpp"
#include "multiplier_layout/layout.hpp"

namespace bodesmith::spice {

struct DisturbanceLibrary {
  /// With the amplitude gains: `.subckt disturbance_amplitude x branch amplitude out`.
  bool amplitude = false;
  /// Every multiplier off by these limits (for checks).
  std::optional<multiplier_layout::ErrorLimits> errors;
};

/// `.subckt disturbance x branch out`; more than two branches have their select lines after `branch`. Beside
/// it, when there is a switch, `.subckt slope_detector x branch`.
std::string disturbance_library(const multiplier_layout::Layout& layout, const std::string& title,
                                const DisturbanceLibrary& options = {});

/// `x branch out`, or with select lines and amplitude.
std::string disturbance_pins(const multiplier_layout::Layout& layout, bool amplitude);

}  // namespace bodesmith::spice
