#include "chain/registry.hpp"

#include "chain/blocks/hysteresis.hpp"
#include "hysteresis/registry.hpp"

// Each function stands in the block's own file under chain/blocks/. A new block is one line here.
#define BODESMITH_BLOCKS(ENTRY)        \
  ENTRY(gain_block)                    \
  ENTRY(lowpass_block)                 \
  ENTRY(highpass_block)                \
  ENTRY(pole_zero_block)               \
  ENTRY(integrator_block)              \
  ENTRY(fractional_lead_lag_block)     \
  ENTRY(resonator_block)               \
  ENTRY(biquad_block)                  \
  ENTRY(parallel_modes_block)          \
  ENTRY(right_half_plane_zero_block)   \
  ENTRY(delay_block)                   \
  ENTRY(saturation_block)              \
  ENTRY(slew_limit_block)              \
  ENTRY(dead_zone_block)               \
  ENTRY(backlash_block)                \
  ENTRY(polynomial_block)              \
  ENTRY(creep_block)                   \
  ENTRY(hum_block)                     \
  ENTRY(drift_block)                   \
  ENTRY(sample_hold_block)             \
  ENTRY(opamp_block)                   \
  ENTRY(multiplier_block)              \
  ENTRY(voltage_controlled_gain_block) \
  ENTRY(comparator_block)              \
  ENTRY(switched_capacitor_block)      \
  ENTRY(noise_block)                   \
  ENTRY(loop_block)

namespace bodesmith::chain {

#define BODESMITH_DECLARE(function) const BlockType& function();
BODESMITH_BLOCKS(BODESMITH_DECLARE)
#undef BODESMITH_DECLARE

Registry<BlockType>& block_type_registry() {
#define BODESMITH_ADDRESS(function) &function(),
  static Registry<BlockType> registry("block type", {BODESMITH_BLOCKS(BODESMITH_ADDRESS)});
#undef BODESMITH_ADDRESS
  static std::size_t models_known = 0;
  const auto& models = hysteresis::model_type_registry().all();
  for (; models_known < models.size(); ++models_known)
    registry.add(hysteresis_block_type(*models[models_known]));
  return registry;
}

Block make_block(std::string_view type) {
  return Block(block_type_registry().get(type));
}

}  // namespace bodesmith::chain

#undef BODESMITH_BLOCKS
