#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace bodesmith::gap {

/// What of a residual is noise, and how that is known.
struct NoiseFloor {
  /// What tells it: what does not repeat over the input's periods, or the level above the input's band.
  /// `periods` of a response: its coherence, which is taken over `periods` averages.
  enum class Source { periods, high_frequency, unknown };
  double rms = 0.0;
  Source source = Source::unknown;
  /// More than this rms is more than noise: kOverFloor times what noise of the longest memory (kLongestNoise) has with this level where it
  /// is of high frequencies, times the floor itself else.
  double most_noise = std::numeric_limits<double>::infinity();
  std::size_t period = 0;  ///< samples; 0: of a response
  int periods = 0;
  /// rms of the part that repeats (periods only): the gap proper; of its harmonics, odd and even ones.
  double odd_rms = 0.0;
  double even_rms = 0.0;
};

/// What is left is more than noise from so many floors on: coherence does not see an instrument's own errors, nor leakage. A record began in
/// another state than rest where the rms of its start's residual is so many times that of the rest.
constexpr double kOverFloor = 1.5;

/// Noise forgets itself within so much of the longest record: what is slower is something missing. With half of it a line has a third
/// less evidence and slow noise passes for a drift less often.
constexpr double kLongestNoise = 0.1;

/// The least rms of a rest, in parts of the largest range: a term that leaves nothing at all leaves rounding.
constexpr double kLeastRest = 1e-7;

/// "periods", "high_frequency" or "unknown", as in diagnosis.json.
std::string to_string(NoiseFloor::Source source);

/// Noise from the residual of a record whose input repeats every `period` samples (at least two whole periods): the part that does
/// not repeat, with the degrees of freedom that the mean takes counted.
NoiseFloor floor_from_periods(const std::vector<double>& residual, std::size_t period);

/// Noise from the residual above the band in which the input has power, taken as white. Unknown when the
/// input leaves too few bins of the spectrum to tell (kNeighbours).
NoiseFloor floor_from_high_frequencies(const std::vector<double>& residual, const std::vector<double>& input,
                                       double step_s);

/// The first that can be said.
NoiseFloor noise_floor(const std::vector<double>& residual, const std::vector<double>& input, double step_s);

}  // namespace bodesmith::gap
