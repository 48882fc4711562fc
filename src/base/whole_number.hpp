#pragma once

#include <cmath>
#include <concepts>
#include <limits>

namespace bodesmith {

/// `value` cut towards zero, held within [low, high]; NaN gives low. For every double that comes from an input: a plain
/// cast of what the type cannot hold is undefined.
template <std::integral Int>
constexpr Int whole_number(double value, Int low = std::numeric_limits<Int>::min(),
                           Int high = std::numeric_limits<Int>::max()) {
  if (!(value > static_cast<double>(low))) return low;
  if (value >= static_cast<double>(high)) return high;
  return static_cast<Int>(value);
}

/// The whole number nearest to `value` (halves away from zero), held likewise: what std::lround leaves undefined is
/// defined here.
template <std::integral Int>
Int nearest_whole(double value, Int low = std::numeric_limits<Int>::min(),
                  Int high = std::numeric_limits<Int>::max()) {
  return whole_number<Int>(std::round(value), low, high);
}

/// Whether a number that stands below a fraction line may be used: above 0, and not so small (below 2.2e-308) that it has
/// lost digits and its inverse is infinite. False for NaN and infinity.
constexpr bool above_zero(double value) {
  return value >= std::numeric_limits<double>::min() && value <= std::numeric_limits<double>::max();
}

}  // namespace bodesmith
