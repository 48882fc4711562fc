#pragma once

#include <complex>
#include <vector>

#include "base/units.hpp"

namespace bodesmith::fpaa {

/// A sampled transfer from one or more inputs over one denominator, in ascending powers of z^-1:
///   H(z) = (b0 + b1 z^-1 + ...) / (a0 + a1 z^-1 + ...),   z = exp(j w / fc) on the frequency axis.
/// Without holds and delays: the relation between samples. Inputs are counted from 1.
struct ZTransfer {
  std::vector<std::vector<double>> numerators{{1.0}};
  std::vector<double> denominator{1.0};

  std::complex<double> response(RadPerSecond w, Hertz clock, std::size_t input = 1) const;
  /// H(1); infinite for an integrator.
  double dc_gain(std::size_t input = 1) const;
};

/// A polynomial in powers of D = 1 - 1/z, the form in which switched-capacitor circuits are written down, in powers of 1/z, or the other
/// way round: the same change of variable. Exact for whole numbers.
std::vector<double> in_one_minus(const std::vector<double>& coefficients);

}  // namespace bodesmith::fpaa
