#include "gap/effects/list.hpp"

namespace bodesmith::gap {

const std::vector<const Effect*>& effects() {
  static const std::vector<const Effect*> all = {
      &gain_error_effect(),
      &offset_effect(),
      &drift_effect(),
      &mains_hum_effect(),
      &time_delay_effect(),
      &amplifier_pole_effect(),
      &resonance_effect(),
      &slew_limit_effect(),
      &saturation_effect(),
      &dead_zone_effect(),
      &backlash_effect(),
      &quadratic_nonlinearity_effect(),
      &cubic_nonlinearity_effect(),
      &cubic_stiffness_effect(),
      &quadratic_stiffness_effect(),
      &drag_effect(),
      &hysteresis_effect(),
      &asymmetric_hysteresis_effect(),
      &rate_dependence_effect(),
      &creep_effect(),
      &multiplier_error_effect(),
      &switch_delay_effect(),
      &opamp_bandwidth_effect(),
      &capacitor_mismatch_effect(),
      &sample_hold_effect(),
  };
  return all;
}

const Effect* find_effect(std::string_view name) {
  for (const auto* effect : effects()) {
    if (effect->name() == name) return effect;
  }
  return nullptr;
}

bool is_free_or_set(const chain::Block& block, std::string_view name) {
  for (const auto& p : block.parameters()) {
    if (p.name() == name) return p.free || p.value != 0.0;
  }
  return true;
}

}  // namespace bodesmith::gap
