#pragma once

#include <complex>
#include <optional>
#include <span>

namespace bodesmith::tuning {

/// What every loop of a family shall keep.
struct LoopLimits {
  double phase_margin_deg = 60.0;
  double gain_margin_db = 6.0;            ///< either way: gain that may be added, and lost
  std::optional<double> max_sensitivity;  ///< |1/(1 + L)|
};

/// Whether 1/(1 + L) is stable for L without poles in the right half plane, by the turns of 1 + L(jw) round 0 (Nyquist),
/// from samples so dense that no step turns by half a turn. `integrators`: poles of L at 0. Needs |L| < 1 at the last
/// sample and beyond; false otherwise.
bool turns_are_stable(std::span<const std::complex<double>> loop, int integrators);

/// How far the samples of L are from keeping the limits: 0 when they do, the sum of the relative shortfalls otherwise, 2
/// more when the loop is unstable. Crossings between neighbours by straight lines in log magnitude and phase.
double shortfall(std::span<const std::complex<double>> loop, int integrators, const LoopLimits& limits);

}  // namespace bodesmith::tuning
