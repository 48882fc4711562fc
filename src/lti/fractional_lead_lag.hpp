#pragma once

#include <complex>

#include "base/units.hpp"

namespace bodesmith {

/// The fractional-order compensator of the disturbance paper, eq. 14:
///   G(s) = ((lambda s + 1) / (x lambda s + 1))^beta,   lambda > 0 (seconds), x > 0, beta real.
/// Corners at 1/lambda (zero of the base for beta > 0) and 1/(x lambda). G(0) = 1, G(infinity) = x^(-beta).
/// With x < 1 and beta > 0 it is a lead: between the corners the magnitude rises by 20 beta dB a decade.
/// The power is the principal one: the base never touches the negative real axis for Re s >= 0.
struct FractionalLeadLag {
  double lambda_s = 1.0;
  double x = 1.0;
  double beta = 0.0;

  std::complex<double> response(RadPerSecond w) const;
  /// ln |G(jw)|, without overflow for large |beta|.
  double log_magnitude(RadPerSecond w) const;
  double phase_rad(RadPerSecond w) const;

  RadPerSecond first_corner() const { return {1.0 / lambda_s}; }
  RadPerSecond second_corner() const { return {1.0 / (x * lambda_s)}; }
  RadPerSecond low_corner() const { return x < 1.0 ? first_corner() : second_corner(); }
  RadPerSecond high_corner() const { return x < 1.0 ? second_corner() : first_corner(); }
  /// Ratio of the corners, >= 1.
  double corner_ratio() const { return x < 1.0 ? 1.0 / x : x; }
  /// True when the magnitude rises with frequency (a lead).
  bool rises() const { return (x < 1.0) == (beta > 0.0); }
};

}  // namespace bodesmith
