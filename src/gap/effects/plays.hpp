#pragma once

#include <vector>

#include "gap/proposal.hpp"

namespace bodesmith::gap {

/// A bank of plays with fixed radii in parallel with the straight line u, as a prandtl_ishlinskii block: linear in its
/// weights, which are the unknowns w[1], w[2], … and start small.
struct PlayBank {
  std::vector<double> radius;  ///< r of the block, the straight line's 0 in front
  std::vector<double> weight;  ///< w of the block
  std::vector<Unknown> unknowns;
  std::vector<double> start;
};
/// Dense enough for any smooth loop. Symmetric and asymmetric memory have the same one: which of them is named must not
/// hang on whose radii happen to lie nearer to the truth.
PlayBank play_bank(double half_range);

}  // namespace bodesmith::gap
