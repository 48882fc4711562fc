#pragma once

#include <complex>
#include <vector>

namespace bodesmith {

/// A measured response at normalised s = j w/w_ref, with the standard deviation of each point's noise.
struct ResponseSamples {
  std::vector<std::complex<double>> s;
  std::vector<std::complex<double>> response;
  std::vector<double> deviation;  ///< > 0
};

/// H(s) = constant + sum of residues/(s - pole), as roots. Complex roots stand in conjugate pairs, next to each other.
struct RationalRoots {
  std::vector<std::complex<double>> poles;
  std::vector<std::complex<double>> zeros;
  double gain = 1.0;  ///< at s -> infinity
  double cost = 0.0;  ///< sum of |error/deviation|^2
};

/// Relaxed vector fitting (B. Gustavsen, "Improving the pole relocating properties of vector fitting", IEEE Trans. Power
/// Delivery 21 (2006) 1587): poles are moved to the zeros of
///   sigma(s) = d' + sum c'_k/(s - p_k), with sigma(s) H(s) = d + sum c_k/(s - p_k) in least squares,
/// unstable ones mirrored, until they rest or `rounds` are over; then the residues. As many zeros as poles.
RationalRoots vector_fit(const ResponseSamples& samples, std::vector<std::complex<double>> poles, int rounds);

}  // namespace bodesmith
