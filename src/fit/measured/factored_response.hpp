#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "fit/measured/vector_fitting.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith {

/// H(s) = gain e^(-s delay) prod (zero factors)/prod (pole factors), each factor
///   s + a   or   s^2 + 2 damping frequency s + frequency^2,
/// pole factors stable, zero factors anywhere: the form in which a measured response is refined, and whose parameters
/// have standard deviations. All in normalised s.
struct FactoredResponse {
  struct Factor {
    bool pair = false;
    double frequency = 1.0;  ///< of a single factor: a
    double damping = 1.0;
    // Standard deviations; infinite where the data do not determine it.
    double frequency_deviation = 0.0;
    double damping_deviation = 0.0;

    std::vector<std::complex<double>> roots() const;
  };
  double gain = 1.0;
  double gain_deviation = 0.0;
  double delay = 0.0;
  double delay_deviation = 0.0;
  std::vector<Factor> poles;
  std::vector<Factor> zeros;
  bool fits_delay = false;  ///< the delay is a free parameter
  double cost = 0.0;        ///< sum of |error/deviation|^2
  bool converged = false;

  /// Conjugate pairs (of which the upper root counts) and single roots, in their order.
  static std::vector<Factor> factors_of(const std::vector<std::complex<double>>& roots);
  /// Zeros farther out than `reach` times the largest |s| are folded into the gain.
  static FactoredResponse of(const RationalRoots& roots, double largest_s, double reach);
  int pole_count() const;
  int zero_count() const;
  int parameter_count() const;
  std::complex<double> response(std::complex<double> s) const;
  std::vector<std::complex<double>> pole_roots() const;
  std::vector<std::complex<double>> zero_roots() const;
};

/// Maximum likelihood for circular normal noise of the given deviations: min sum |H(s_i) - H_i|^2/deviation_i^2 by
/// Levenberg-Marquardt with exact derivatives, from `start`.
FactoredResponse refine(const FactoredResponse& start, const ResponseSamples& samples, int iterations);

/// The model without the zeros above the band that the samples do not ask for (Schwarz's criterion): a response that
/// falls faster than the search supposed is first met with a ring of zeros just beyond the band.
FactoredResponse without_far_zeros(FactoredResponse model, const ResponseSamples& samples);

/// The model with the zeros that the samples cannot tell from 0 (Schwarz's criterion) at 0: a high-pass or a band-pass lets
/// nothing through at rest, and not something of a frequency far below its samples.
FactoredResponse with_zeros_at_rest(FactoredResponse model, const ResponseSamples& samples);

}  // namespace bodesmith
