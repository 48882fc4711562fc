#pragma once

#include <string>
#include <vector>

#include "approximate/approximate.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/waveform/waveform_error.hpp"
#include "project/project.hpp"

namespace bodesmith::project {

/// One set of integer sections that could be built for the target, and how well it meets it. Without a plant there is one, of
/// which sections and points_max_db are known (of a fractional transfer its largest error over the band).
struct Alternative {
  std::string name;  ///< "cascade, minimax", "direct fit, 3 poles", "waveform fit, 2 poles"
  enum class Kind { cascade, direct, waveform } kind = Kind::cascade;
  Sections sections;
  double points_max_db = 0.0;        ///< largest error at the target points above the base
  double phase_at_points_deg = 0.0;  ///< largest phase shift at the target points
  double above_band_db = 0.0;        ///< gain at infinity: what it does to noise above the band
  WaveformError waveform;            ///< at the tracked frequencies, percent of range
  /// Worst tracking error of a stage that reads its drive, the sections in a generator fed by its own drive; percent
  /// of range, pure delay removed (tracked_plant.hpp).
  double tracked_percent = 0.0;
  std::vector<double> tracked_at_percent;  ///< the same at each tracked frequency
  int fpaa_blocks = 0;  ///< one per real pole-zero pair, and one more where the sign needs it
};

/// The cascade's approximation first, then direct fits (real poles and zeros, corners up to five times the
/// highest point) and waveform fits of rising order.
std::vector<Alternative> make_alternatives(const Project& project, const CascadeApproximation& approximation);

/// Indices in the order in which they should be built, by the project's [choose]; the first one that the
/// hardware can make is taken:
///   tracking         smallest tracked_percent first
///   as_asked         the cascade's approximation, nothing else
///   fewest_sections  those with every target point within limits.points_db (0.05 dB when absent), fewest
///                    poles first
///   waveform         smallest worst-case waveform error first
std::vector<std::size_t> rank_alternatives(const Project& project,
                                           const std::vector<Alternative>& alternatives);

/// Largest error at the target's points, dB. The base is left out: its gain is a consequence of the fit, not a condition.
double max_error_at_points(const Project& project, const FrequencyResponse& response);

/// The frequencies at which the stages are compared: the target points and every corner of cascade and sections; without a plant
/// the target's own.
Band design_band(const Project& project, const std::optional<CascadeFit>& fit, const Sections& sections);

/// The path of the disturbance generator that the project's compensator stands in.
DrivenPath compensated_path(const Project& project);

}  // namespace bodesmith::project
