#pragma once

#include <complex>
#include <vector>

#include "base/units.hpp"

namespace bodesmith::fpaa {

/// A sampled transfer in ascending powers of z^-1:
///   H(z) = (b0 + b1 z^-1 + ...) / (a0 + a1 z^-1 + ...),   z = exp(j w / fc) on the frequency axis.
/// Without holds and delays: the relation between samples.
struct ZTransfer {
  std::vector<double> numerator{1.0};
  std::vector<double> denominator{1.0};

  std::complex<double> response(RadPerSecond w, Hertz clock) const;
  /// H(1); infinite for an integrator.
  double dc_gain() const;
};

/// The same transfer in powers of D = 1 - 1/z, the form in which switched-capacitor circuits are written
/// down:
///   H = (n0 + n1 D + ...) / (d0 + d1 D + ...).
/// D is small where the clock is fast, so that capacitors need not be whole numbers for this to be exact
/// where ZTransfer would cancel.
struct DeltaTransfer {
  std::vector<double> numerator{1.0};
  std::vector<double> denominator{1.0};

  std::complex<double> response(RadPerSecond w, Hertz clock) const;
  /// In powers of 1/z; exact for whole-number coefficients.
  ZTransfer in_z() const;
};

/// The same transfer in powers of D.
DeltaTransfer in_delta(const ZTransfer& z);

}  // namespace bodesmith::fpaa
