#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "signal/spectrum.hpp"
#include "simulate/loop.hpp"

namespace bodesmith::simulate {

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

  /// A row a line: frequency_hz, (harmonic, its multiple of the fundamental, when u repeats,) u_amplitude,
  /// u_phase_deg, y_amplitude, y_phase_deg. `input` stands for the u in the names.
  std::string spectra_csv(const std::string& input = "u") const;
  /// A row a level: period (from 1), u, ascending, descending, height_percent (of that period).
  std::string loops_csv(const std::string& input = "u") const;
  /// {"periodic", "resolution_hz", "fundamental_hz", "thd_percent", "harmonics": the first ten}.
  Json spectra_json(const std::string& input = "u") const;
  /// {"periods", "height", "height_percent" (of the last), "largest_height_percent"}.
  Json loops_json() const;
};

/// `fundamental`: of u, when known; else a repetition is looked for. Both of one length above 1.
SignalStudy study_signals(std::span<const double> u, std::span<const double> y, double start_s, double step_s,
                          std::optional<Hertz> fundamental);

}  // namespace bodesmith::simulate
