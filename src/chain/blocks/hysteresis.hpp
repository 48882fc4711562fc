#pragma once

#include "chain/block.hpp"
#include "hysteresis/model_type.hpp"

namespace bodesmith::chain {

/// The block type of a model: the model's name and parameters. One object a model, made at the first call.
const BlockType& hysteresis_block_type(const hysteresis::ModelType& model);

/// The model with the values of a block whose hysteresis_model() is not null. DesignError when they are not
/// legal.
hysteresis::Model hysteresis_model_of(const Block& block);
/// The other way round.
Block hysteresis_block(const hysteresis::Model& model);

}  // namespace bodesmith::chain
