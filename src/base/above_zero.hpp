#pragma once

#include <limits>

namespace bodesmith {

/// Whether a number that stands below a fraction line may be used: above 0, and not so small (below 2.2e-308) that it has
/// lost digits and its inverse is infinite. False for NaN and infinity.
constexpr bool above_zero(double value) {
  return value >= std::numeric_limits<double>::min() && value <= std::numeric_limits<double>::max();
}

}  // namespace bodesmith
