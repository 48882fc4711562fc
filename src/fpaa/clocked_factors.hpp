#pragma once

#include <cmath>
#include <complex>
#include <numbers>

namespace bodesmith::fpaa {

// Factors of sampled signals at a frequency, `half` = half the angle that a period (or what it counts) turns by. Sizes may be
// negative there, which std::polar does not take.

/// 1 - exp(-2j half), without cancellation where it is small.
inline std::complex<double> difference_factor(double half) {
  return 2.0 * std::sin(half) * std::polar(1.0, 0.5 * std::numbers::pi - half);
}

/// The mean of exp(-2j half k), k = 0 ... count-1.
inline std::complex<double> mean_factor(double count, double half) {
  if (count == 1.0 || std::abs(std::sin(half)) < 1e-12) return 1.0;
  return std::sin(count * half) / (count * std::sin(half)) * std::polar(1.0, -half * (count - 1.0));
}

/// What a hold makes of the sine: sin(half)/half exp(-j half).
inline std::complex<double> hold_factor(double half) {
  return (std::abs(half) < 1e-9 ? 1.0 : std::sin(half) / half) * std::polar(1.0, -half);
}

}  // namespace bodesmith::fpaa
