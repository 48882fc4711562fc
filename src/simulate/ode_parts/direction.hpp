#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodesmith::simulate {

/// Which way an input moves, for an event at each turn.
struct Direction {
  bool rising = true;
  double fastest = 0.0;  ///< slope so far

  /// Slower than this is rest, from which the input may move on either way.
  double rest() const {
    constexpr double kPart = 1e-9;
    return std::max(kPart * fastest, std::numeric_limits<double>::min());
  }
  /// Crosses zero where the input has turned.
  double event(double slope) const { return slope + (rising ? rest() : -rest()); }
  void passed(double slope) { fastest = std::max(fastest, std::abs(slope)); }
};

}  // namespace bodesmith::simulate
