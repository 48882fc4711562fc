#pragma once

#include <string_view>

#include "base/registry.hpp"
#include "chain/block.hpp"

namespace bodesmith::chain {

/// Every block type, in the order of the documentation: those of chain/blocks/, then one for each model of
/// hysteresis::model_type_registry(), also for models that were added there later.
Registry<BlockType>& block_type_registry();

/// A block with default values; InputError for an unknown type.
Block make_block(std::string_view type);

}  // namespace bodesmith::chain
