#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "chain/block.hpp"

namespace bodesmith::chain {

/// Every block type, in the order of the documentation. A new one is one line in registry.cpp.
const std::vector<const BlockType*>& block_types();
/// Null when there is no such type.
const BlockType* find_block_type(std::string_view name);
/// A block with standard values; std::logic_error for an unknown type (for programs; files go through
/// model_file.hpp).
Block make_block(std::string_view type);

}  // namespace bodesmith::chain
