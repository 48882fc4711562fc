#pragma once

#include <optional>

#include "lti/fractional_transfer.hpp"

namespace bodesmith {

/// Where the zeros of D(s) = sum a_k s^alpha_k lie, on the principal sheet.
struct FractionalStability {
  /// Zeros with Re s > 0, by the argument principle, after the lowest power is factored out:
  ///   (alpha_max pi/2 - total turn of D(jw), w = 0 to infinity)/pi.
  int unstable_poles = 0;
  /// The same number by Matignon's theorem, where the powers have a common step q (to a denominator of 60):
  /// roots sigma of the polynomial in sigma = s^q with |arg sigma| < q pi/2.
  std::optional<int> matignon_count;
  double common_step = 0.0;  ///< q; 0 when there is none
  double powers_of_s = 0.0;  ///< the lowest power factored out: an integrator s^-powers_of_s in G
  /// Smallest |D(jw)| over the sum of its terms' sizes: 0 is a pole on the axis.
  double nearest_to_axis = 0.0;
  bool stable() const { return unstable_poles == 0; }
};
FractionalStability fractional_stability(const FractionalPolynomial& denominator);

}  // namespace bodesmith
