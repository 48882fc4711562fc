#pragma once

namespace bodesmith::fpaa {

/// How a capacitor's number chooses its units: not publicly known for this chip.
enum class UnitArray {
  nested,  ///< m units hold the n < m that were there before
  binary,  ///< groups of 1, 2, 4, … 128 units: from 127 to 128 all of them change
};

const char* to_string(UnitArray array);

/// What is known of a capacitor that goes from n to m units, when it was n + e before: s of its units stay, so
/// that it is m + e s/n and a normal error of variance
///   k^2 (s (n - s)/n + (m - s))
/// (the s that stay share e with the n - s that go; m - s are new; k of one unit as in mismatch.hpp).
struct ExchangedUnits {
  double kept = 1.0;      ///< s/n
  double variance = 0.0;  ///< units^2
};
ExchangedUnits exchanged_units(int from, int to, UnitArray array, double unit_variance);

}  // namespace bodesmith::fpaa
