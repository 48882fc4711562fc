#pragma once

#include <complex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "lti/sections.hpp"

namespace bodesmith {

/// A fractional lead in normalised form, r = sqrt(kappa), kappa = b/a > 1 the ratio of its corners, centre at
/// 1 rad/s,
///   P(s)^beta = ((1 + r s)/(1 + s/r))^beta,
/// is approximated by H(s) = gain * prod (s - zero_k)/(s - pole_k).
struct NormalisedApproximation {
  double gain = 1.0;
  std::vector<std::complex<double>> zeros;
  std::vector<std::complex<double>> poles;
};

/// What every method is asked for.
struct ApproximationTask {
  double kappa = 10.0;  ///< > 1
  double beta = 0.5;    ///< > 0: a lag is the reciprocal of its lead's approximation
  int order = 4;
  bool real_roots = true;  ///< real poles and zeros even where a complex pair would be closer (|beta| > 2)
  bool over_band = false;  ///< minimax only: equal ripple over [a, b] instead of over all frequencies
};

/// One way to approximate, in a file of its own.
struct ApproximationMethod {
  std::string_view name;
  std::string_view source;  ///< paper, equation
  /// Throws DesignError with a reason for an order (or beta) that the method cannot do well.
  NormalisedApproximation (*approximate)(const ApproximationTask& task);
  /// Whole powers of ((s/a + 1)/(s/b + 1)) are split off first when |beta| > 1, and count in the order.
  bool splits_whole_powers;
};

/// Every method, the default first.
std::span<const ApproximationMethod> approximation_methods();
/// Throws InputError listing the names.
const ApproximationMethod& approximation_method(std::string_view name);

}  // namespace bodesmith
