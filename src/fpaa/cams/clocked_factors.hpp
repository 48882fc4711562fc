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
  // Whole turns are no angle: left out before they cost digits.
  const double rest = half - std::round(half / std::numbers::pi) * std::numbers::pi;
  const auto turned = std::polar(1.0, -rest * (count - 1.0));
  if (std::abs(rest) < 1e-9 / count) return turned;
  return std::sin(count * rest) / (count * std::sin(rest)) * turned;
}

/// What a hold makes of the sine: sin(half)/half exp(-j half).
inline std::complex<double> hold_factor(double half) {
  return (std::abs(half) < 1e-9 ? 1.0 : std::sin(half) / half) * std::polar(1.0, -half);
}

}  // namespace bodesmith::fpaa
