#pragma once

#include <complex>
#include <string_view>
#include <vector>

#include "signal/disturbance.hpp"

namespace bodesmith {

/// Where the compensator stands in the disturbance generator.
enum class DrivenPath {
  whole,       ///< behind the branch switch: it filters the whole periodic disturbance
  ascending,   ///< in the ascending polynomial's own path, before the switch; only the rising half counts
  descending,  ///< the same for the descending one
};
std::string_view to_string(DrivenPath path);

/// The disturbance polynomials under a triangle x(t), 0 to 1 in the first half of the period and back in the
/// second, without gain tables: exact Fourier coefficients U_k = integral_0^1 u e^(-2 pi j k phase) d phase.
struct TriangleSeries {
  std::vector<std::complex<double>> coefficient;  ///< k = 0 ... harmonics; U_(-k) is the conjugate
  Disturbance disturbance;
  DrivenPath path = DrivenPath::whole;

  /// u at a phase in [0, 1).
  double value(double phase) const;
};

/// What enters a compensator in that path: the switched disturbance, or one branch's polynomial on both
/// slopes.
TriangleSeries triangle_series(const Disturbance& disturbance, DrivenPath path, std::size_t harmonics);

}  // namespace bodesmith
