#pragma once

#include "gap/effect.hpp"

namespace bodesmith::gap {

// Each stands in a file of its own.
const Effect& gain_error_effect();
const Effect& offset_effect();
const Effect& drift_effect();
const Effect& mains_hum_effect();
const Effect& time_delay_effect();
const Effect& amplifier_pole_effect();
const Effect& resonance_effect();
const Effect& slew_limit_effect();
const Effect& saturation_effect();
const Effect& dead_zone_effect();
const Effect& backlash_effect();
const Effect& quadratic_nonlinearity_effect();
const Effect& cubic_nonlinearity_effect();
const Effect& cubic_stiffness_effect();
const Effect& quadratic_stiffness_effect();
const Effect& drag_effect();
const Effect& hysteresis_effect();
const Effect& asymmetric_hysteresis_effect();
const Effect& rate_dependence_effect();
const Effect& creep_effect();
const Effect& multiplier_error_effect();
const Effect& switch_delay_effect();
const Effect& opamp_bandwidth_effect();
const Effect& capacitor_mismatch_effect();
const Effect& sample_hold_effect();

/// Whether the parameter already has a value of its own, or is refitted anyhow.
bool is_free_or_set(const chain::Block& block, std::string_view name);

}  // namespace bodesmith::gap
