#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bodesmith {

/// Largest length <= n with no prime factor above 5 (fast to transform).
std::size_t smooth_length(std::size_t n);

/// Discrete Fourier transform of a real signal, bins 0 … n/2 (not scaled). Give it a smooth_length() signal
/// when speed matters.
std::vector<std::complex<double>> half_spectrum(const std::vector<double>& v);
/// Its inverse, n samples.
std::vector<double> from_half_spectrum(const std::vector<std::complex<double>>& bins, std::size_t n);

/// Energy of v a bin (Hann window, zero mean left in), bins 0 … n/2 over smooth_length(v.size()) samples;
/// scaled so that the sum over all bins is the mean square of v.
struct Periodogram {
  double bin_hz = 0.0;
  std::vector<double> power;
};
Periodogram periodogram(const std::vector<double>& v, double step_s);

/// A record of the same spectrum with random phases: same colour, no relation to anything.
std::vector<double> phase_surrogate(const std::vector<double>& v, std::uint64_t seed);

/// Period of v in samples (at least two of them in the record), 0 when it does not repeat. Two periods count
/// as equal when they differ by less than `tolerance` of the signal's rms.
std::size_t find_period(const std::vector<double>& v, double tolerance = 0.03);

}  // namespace bodesmith
