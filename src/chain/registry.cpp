#include "chain/registry.hpp"

#include <mutex>

#include "chain/blocks/hysteresis.hpp"
#include "hysteresis/model_type.hpp"

// Each function stands in the block's own file under chain/blocks/. A new block is one line here.
namespace bodesmith::chain {

/// Without the hysteresis models.
BODESMITH_REGISTRY(BlockType, own_block_types, "block type", gain_block, lowpass_block, highpass_block,
                   pole_zero_block, integrator_block, fractional_lead_lag_block, resonator_block,
                   biquad_block, parallel_modes_block, right_half_plane_zero_block, delay_block,
                   saturation_block, slew_limit_block, dead_zone_block, backlash_block, polynomial_block,
                   creep_block, hum_block, drift_block, sample_hold_block, opamp_block, multiplier_block,
                   voltage_controlled_gain_block, comparator_block, switched_capacitor_block, noise_block,
                   loop_block)

Registry<BlockType>& block_type_registry() {
  static std::mutex mutex;  // threads that are the first to ask
  const std::lock_guard<std::mutex> lock(mutex);
  Registry<BlockType>& registry = own_block_types();
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
