#pragma once

#include <cstdint>
#include <vector>

namespace bodesmith {

/// Energy of v a bin (Hann window, zero mean left in), bins 0 … n/2 over smooth_length(v.size()) samples
/// (numeric/fourier.hpp); scaled so that the sum over all bins is the mean square of v.
struct Periodogram {
  double bin_hz = 0.0;
  std::vector<double> power;
};
Periodogram periodogram(const std::vector<double>& v, double step_s);

/// A record of the same spectrum with random phases: same colour, no relation to anything.
std::vector<double> phase_surrogate(const std::vector<double>& v, std::uint64_t seed);

}  // namespace bodesmith
