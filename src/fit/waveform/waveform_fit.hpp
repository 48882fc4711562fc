#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "fit/waveform/waveform_error.hpp"
#include "lti/sections.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith {

/// Sections that minimise the time-domain error of the compensating waveform itself (waveform_error.hpp): all
/// harmonics, phase included, all operating frequencies together.
struct WaveformFitOptions {
  int order = 2;  ///< poles (and zeros), 1 to 6
  DrivenPath path = DrivenPath::whole;
  bool worst = false;  ///< make the worst frequency's rms smallest; otherwise the rms over frequencies
  bool real = true;    ///< real poles and zeros; otherwise pairs of at least `min_damping` too
  /// Of pairs: four free resonators would meet the frequencies of the table and nothing between them.
  double min_damping = 0.5;
  std::vector<Hertz> operating{};  ///< empty: the frequencies of the rate table
  std::uint64_t seed = 1;
  int starts = 16;
};

struct WaveformFit {
  Sections sections;
  WaveformError error;  ///< at the operating frequencies
  /// At the geometric mean of each two neighbouring operating frequencies, the rate gains interpolated: with
  /// the sections and with none.
  WaveformError between;
  WaveformError between_none;
  WaveformError none;          ///< no rate compensation, gain 1
  double constant_gain = 1.0;  ///< best fixed gain in the norm asked for
  WaveformError constant;
  /// The magnitude-only way next to it: the fractional cascade interpolated through the rate gains
  /// (cascade_fit.hpp).
  WaveformError magnitude_only;
  /// No linear filter, causal or not, of any order is better (in the norm asked for; waveform_problem.hpp).
  double lower_bound_percent = 0.0;
  int starts_tried = 0;
  std::vector<std::string> warnings;

  Json report_json() const;
};

/// The sections alone, without all that they are compared with, which takes longer than they do. Errors as below.
struct WaveformSections {
  Sections sections;
  int starts_tried = 0;
};
WaveformSections fit_waveform_sections(const Disturbance& disturbance, const WaveformFitOptions& options);

/// Throws InputError for an order out of range, a disturbance without rate table and no operating
/// frequencies, or a path whose branch needs no compensator.
WaveformFit fit_waveform(const Disturbance& disturbance, const WaveformFitOptions& options);

/// The path that needs a filter: the whole disturbance when both branches have the same rate gains, otherwise
/// the one branch that is not static. Throws InputError when both branches need different ones (choose) or
/// none does.
DrivenPath path_to_compensate(const Disturbance& disturbance);

}  // namespace bodesmith
