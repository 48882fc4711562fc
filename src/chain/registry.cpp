#include "chain/registry.hpp"

#include <stdexcept>

#include "chain/blocks/block_list.hpp"

namespace bodesmith::chain {

const std::vector<const BlockType*>& block_types() {
  static const std::vector<const BlockType*> all = [] {
    std::vector<const BlockType*> types = {
        &gain_block(),        &lowpass_block(),
        &pole_zero_block(),   &fractional_lead_lag_block(),
        &resonator_block(),   &delay_block(),
        &saturation_block(),  &slew_limit_block(),
        &dead_zone_block(),   &backlash_block(),
        &polynomial_block(),  &creep_block(),
        &hum_block(),         &drift_block(),
        &sample_hold_block(), &opamp_block(),
        &multiplier_block(),  &voltage_controlled_gain_block(),
        &comparator_block(),  &switched_capacitor_block(),
        &noise_block(),
    };
    for (const BlockType* type : hysteresis_blocks()) types.push_back(type);
    return types;
  }();
  return all;
}

const BlockType* find_block_type(std::string_view name) {
  for (const BlockType* type : block_types()) {
    if (type->name() == name) return type;
  }
  return nullptr;
}

Block make_block(std::string_view type) {
  const BlockType* found = find_block_type(type);
  if (found == nullptr) throw std::logic_error("no block type '" + std::string(type) + "'");
  return Block(*found);
}

}  // namespace bodesmith::chain
