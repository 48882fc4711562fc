#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "signal/period.hpp"
#include "signal/periodogram.hpp"

namespace bodesmith::simulate {

/// y over u on evenly spaced levels of u, once while u rises and once while it falls. Levels that u does not
/// cross in both directions are left out. Where u crosses a level several times, the crossings count that lie
/// farthest apart.
struct Loop {
  std::vector<double> u;
  std::vector<double> ascending;
  std::vector<double> descending;
  double height = 0.0;          ///< largest |ascending - descending|
  double height_percent = 0.0;  ///< in percent of the range of y; 0 for a range of 0
};

/// 101 levels strictly between the extremes of u. u and y of one length, straight lines between samples.
Loop hysteresis_loop(std::span<const double> u, std::span<const double> y);

/// Spectra and hysteresis loops of an input u and an output y.
///
/// While u repeats itself, lines are those of its last whole repetition (exact, no window), and there is one
/// loop a repetition, counted from the first sample. Otherwise the whole record is one windowed spectrum and
/// one loop.
struct SignalStudy {
  std::optional<Repetition> repetition;
  std::optional<Hertz> fundamental;  ///< cycles / repetition
  Spectrum u;
  Spectrum y;
  std::optional<double> u_distortion_percent;  ///< THD, when the input repeats and has a fundamental
  std::optional<double> y_distortion_percent;
  std::vector<Loop> loops;
};

/// `fundamental`: of u, when known; else a repetition is looked for, and the cycles within it. Both of one length above 1.
SignalStudy study_signals(std::span<const double> u, std::span<const double> y, double start_s, double step_s,
                          std::optional<Hertz> fundamental);

// A signal study as it is written. `input` stands for the u in the names.

/// A row a line: frequency_hz, (harmonic, its multiple of the fundamental, when u repeats,) u_amplitude,
/// u_phase_deg, y_amplitude, y_phase_deg.
std::string spectra_csv(const SignalStudy& study, const std::string& input = "u");
/// A row a level: period (from 1), u, ascending, descending, height_percent (of that period).
std::string loops_csv(const SignalStudy& study, const std::string& input = "u");
/// {"periodic", "resolution_hz", "fundamental_hz", "thd_percent", "harmonics": the first ten}.
Json spectra_json(const SignalStudy& study, const std::string& input = "u");
/// {"periods", "height", "height_percent" (of the last), "largest_height_percent"}.
Json loops_json(const SignalStudy& study);

}  // namespace bodesmith::simulate
