#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "simulate/signal_study.hpp"

namespace bodesmith::simulate {

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
