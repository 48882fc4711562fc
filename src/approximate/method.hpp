#pragma once

#include <complex>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/registry.hpp"

namespace bodesmith {

/// A fractional lead in normalised form, r = sqrt(kappa), kappa = b/a > 1 the ratio of its corners, centre at 1 rad/s,
///   P(s)^beta = ((1 + r s)/(1 + s/r))^beta,
/// is approximated by
///   H(s) = gain * prod (s - zero_k)/(s - pole_k).
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
  bool over_band =
      false;  ///< equal ripple over [a, b] instead of over all frequencies, where a method has a choice
};

/// One way to approximate a fractional term, in a file of its own; the table of them stands in methods.cpp.
class Method {
 public:
  virtual ~Method() = default;

  /// As users name it.
  virtual std::string_view name() const = 0;
  /// Refused: an order or a beta that the method cannot do well.
  virtual Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const = 0;
  /// Whether whole powers of ((s/a + 1)/(s/b + 1)) are split off first when |beta| > 1; they count in the order, and
  /// `approximate` then sees 0 < beta < 1.
  virtual bool splits_whole_powers() const { return true; }
};

/// Every method, the default first.
Registry<Method>& method_registry();

}  // namespace bodesmith
