#include "gap/effect.hpp"

namespace bodesmith::gap {

// Each stands in a file of effects/, which defines `const Effect& NAME_effect()`.
BODESMITH_REGISTRY(Effect, effect_registry, "effect", gain_error_effect, offset_effect, drift_effect,
                   mains_hum_effect, time_delay_effect, amplifier_pole_effect, resonance_effect,
                   parallel_mode_effect, right_half_plane_zero_effect, slew_limit_effect, saturation_effect,
                   dead_zone_effect, backlash_effect, quadratic_nonlinearity_effect,
                   cubic_nonlinearity_effect, cubic_stiffness_effect, quadratic_stiffness_effect, drag_effect,
                   hysteresis_effect, asymmetric_hysteresis_effect, rate_dependence_effect, creep_effect,
                   multiplier_error_effect, part_value_effect, switch_delay_effect, opamp_bandwidth_effect,
                   capacitor_mismatch_effect, sample_hold_effect)

}  // namespace bodesmith::gap
