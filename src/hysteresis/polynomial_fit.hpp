#pragma once

#include <array>
#include <span>

namespace bodesmith::hysteresis {

/// Ways to find the gain K_i between the polynomial of one frequency or amplitude and the basis one (eq.
/// 11-13).
enum class GainReading {
  /// p_i ≈ K p_1: K = Σ p_1 p_i / Σ p_1². What eq. 17 needs (the compensator multiplies the basis). The
  /// default.
  basis_times_gain,
  /// p_1 ≈ K p_i: K = Σ p_1 p_i / Σ p_i², eq. 13 as printed.
  as_printed,
};
/// Over x_k evenly spread on [0, 1], in closed form (integrals instead of sums).
double disturbance_gain(const std::array<double, 3>& basis, const std::array<double, 3>& other,
                        GainReading reading = GainReading::basis_times_gain);

/// Eq. 4, 5: a1, a2, a3 = −a1 − a2 by least squares over the samples (x_i, d_i).
struct PolynomialFit {
  std::array<double, 3> a{};
  std::array<double, 2> deviation{};  ///< standard deviation of a1 and a2
  double rms = 0.0;
};
PolynomialFit fit_polynomial(std::span<const double> x, std::span<const double> d);
/// Eq. 10.
struct SineFit {
  double amplitude = 0.0;
  double deviation = 0.0;
  double rms = 0.0;
};
SineFit fit_sine(std::span<const double> x, std::span<const double> d);

}  // namespace bodesmith::hysteresis
