#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/units.hpp"

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

/// Lines of a real, uniformly sampled signal, x(t) = sum_i amplitude_i cos(2 pi f_i t + phase_i), from 0 Hz
/// to half the sampling rate.
struct Spectrum {
  std::vector<Hertz> frequency;
  std::vector<double> amplitude;
  std::vector<double> phase_deg;  ///< (-180, 180]; 0 for lines below 1e-10 of the largest
};

/// `periodic`: the samples are whole periods (the one that would repeat the first left out), and the lines
/// are exact. Otherwise the samples are weighted with a Hann window, scaled so that a sine on a line keeps
/// its amplitude; a line then leaks into its two neighbours. `start_s` is the time of the first sample.
/// std::logic_error below two samples.
Spectrum spectrum_of(std::span<const double> x, double start_s, double step_s, bool periodic);

/// Total harmonic distortion in percent, 100 sqrt(sum_{k>=2} A_k^2)/A_1 over all harmonics of line
/// `fundamental` (an index of the spectrum) up to half the sampling rate. Nothing when A_1 is 0.
std::optional<double> distortion_percent(const Spectrum& spectrum, std::size_t fundamental);

}  // namespace bodesmith
