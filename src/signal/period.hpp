#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "base/units.hpp"

namespace bodesmith {

/// `cycles` periods of a signal are `samples` sampling steps: a signal of 3 Hz sampled at 1 kHz repeats after
/// 1000 samples and 3 cycles.
struct Repetition {
  std::size_t samples = 0;
  std::size_t cycles = 1;
};

/// The fewest samples after which the whole record repeats itself, within 1e-9 of its range; it must do so at
/// least once in full. For signals that were computed: a comparison of samples, which rounding of an
/// autocorrelation could not decide. Nothing for a constant or a record that does not repeat.
std::optional<Repetition> find_repetition(std::span<const double> u);
/// The same for a known fundamental: the fewest samples that are whole cycles of it within 1e-6 of a sample.
/// Nothing when no such number fits into the record.
std::optional<Repetition> repetition_of(Hertz fundamental, double step_s, std::size_t samples);

/// Period of a measured signal in samples (at least two of them in the record), 0 when it does not repeat.
/// Two periods count as equal when they differ by less than 3 % of the signal's rms: the mean squared
/// difference at every lag by one autocorrelation.
std::size_t find_period(std::span<const double> v);

}  // namespace bodesmith
