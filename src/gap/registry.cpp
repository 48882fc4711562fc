#include "gap/effect.hpp"

namespace bodesmith::gap {

// Each stands in a file of its own in effects/, which defines `const Effect& NAME_effect()`.
#define BODESMITH_EFFECTS(ENTRY) \
  ENTRY(gain_error)              \
  ENTRY(offset)                  \
  ENTRY(drift)                   \
  ENTRY(mains_hum)               \
  ENTRY(time_delay)              \
  ENTRY(amplifier_pole)          \
  ENTRY(resonance)               \
  ENTRY(parallel_mode)           \
  ENTRY(right_half_plane_zero)   \
  ENTRY(slew_limit)              \
  ENTRY(saturation)              \
  ENTRY(dead_zone)               \
  ENTRY(backlash)                \
  ENTRY(quadratic_nonlinearity)  \
  ENTRY(cubic_nonlinearity)      \
  ENTRY(cubic_stiffness)         \
  ENTRY(quadratic_stiffness)     \
  ENTRY(drag)                    \
  ENTRY(hysteresis)              \
  ENTRY(asymmetric_hysteresis)   \
  ENTRY(rate_dependence)         \
  ENTRY(creep)                   \
  ENTRY(multiplier_error)        \
  ENTRY(part_value)              \
  ENTRY(switch_delay)            \
  ENTRY(opamp_bandwidth)         \
  ENTRY(capacitor_mismatch)      \
  ENTRY(sample_hold)

#define BODESMITH_DECLARE(name) const Effect& name##_effect();
BODESMITH_EFFECTS(BODESMITH_DECLARE)
#undef BODESMITH_DECLARE

Registry<Effect>& effect_registry() {
#define BODESMITH_ENTRY(name) &name##_effect(),
  static Registry<Effect> registry("effect", {BODESMITH_EFFECTS(BODESMITH_ENTRY)});
#undef BODESMITH_ENTRY
  return registry;
}

#undef BODESMITH_EFFECTS

}  // namespace bodesmith::gap
