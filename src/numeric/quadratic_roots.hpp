#pragma once

#include <cmath>
#include <complex>
#include <vector>

namespace bodesmith {

/// Roots of c0 + c1 s + c2 s^2, leading coefficients of 0 left out; real ones without cancellation, the larger first.
inline std::vector<std::complex<double>> quadratic_roots(double c0, double c1, double c2) {
  if (c2 == 0.0)
    return c1 == 0.0 ? std::vector<std::complex<double>>{} : std::vector<std::complex<double>>{-c0 / c1};
  const double discriminant = c1 * c1 - 4.0 * c2 * c0;
  if (discriminant < 0.0) {
    const std::complex<double> root(-c1 / (2.0 * c2), std::sqrt(-discriminant) / (2.0 * std::abs(c2)));
    return {root, std::conj(root)};
  }
  const double q = -0.5 * (c1 + std::copysign(std::sqrt(discriminant), c1));
  return {q / c2, q == 0.0 ? 0.0 : c0 / q};
}

}  // namespace bodesmith
