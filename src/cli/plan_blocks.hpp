#pragma once

#include <vector>

#include "base/document.hpp"
#include "chain/block.hpp"

namespace bodesmith::cli {

/// An FPAA plan as blocks that bear its CAMs' names: the analog sections whose roots, z = exp(s/clock), are those that the
/// capacitors make; a zero that no s has (z <= 0) lies at infinity. Holds are not in it. InputError for a plan that is no chain.
std::vector<chain::Block> plan_blocks(const Node& plan);

}  // namespace bodesmith::cli
