#pragma once

#include <optional>
#include <vector>

#include "base/json_fwd.hpp"
#include "schematic/deviations.hpp"
#include "synthesis/controller/as_built.hpp"
#include "synthesis/controller/controller.hpp"

namespace bodesmith::controller {

/// The loop of the self-fed form, cut at the generator's argument (the powers and weights read x instead of v) and
/// biased where it is steepest: one branch, the drive and the rate with the greatest or the least K d'.
struct LoopPoint {
  Disturbance::Branch which = Disturbance::Branch::ascending;
  Hertz rate;  ///< of the triangle whose gain stands
  double drive_v = 0.0;
  double slope = 0.0;  ///< K d' there: the loop's gain at rest, above 0 for negative feedback
  /// From ngspice with the real op-amps and multipliers: v/x = -L.
  double greatest_gain = 0.0;  ///< |L|
  Hertz greatest_at;
  std::optional<double> phase_margin_deg;  ///< none: |L| < 1 at every frequency, the loop cannot oscillate
  std::optional<double>
      gain_margin_db;    ///< where L is real and negative, the smallest of all such; none: nowhere
  double nearest = 0.0;  ///< least |1 + L|: 1 over the greatest amplification of a disturbance
  Hertz bandwidth;       ///< |L| at 0.707 of its value at rest
};

/// Greatest and least K d' of both branches, each with its loop in ngspice from 100 Hz to 100 MHz. Empty for forms
/// without a loop. Throws InputError when ngspice is missing.
std::vector<LoopPoint> measure_loop(const AnalogController& controller);

/// A two-pin library `loop in out` around the open controller at that point: its response is v/x = -L.
std::string loop_library(const AnalogController& controller, const LoopPoint& point);

/// One tracked frequency as built: ngspice on the emitted netlist, the stage on the drive it found.
struct AsBuilt {
  Hertz frequency;
  tracking::TrackingError error;
  tracking::TrackingError without;        ///< no controller: v = r
  double cvode_difference_percent = 0.0;  ///< rms of v in time against CVODE on the netlist, percent of range
  double start_up_percent = 0.0;  ///< rms of v in the first repeat, from rest, against the settled one
  double wall_s = 0.0;            ///< of ngspice
};

std::vector<AsBuilt> measure_as_built(const AnalogController& controller,
                                      const std::vector<Hertz>& frequencies,
                                      const tracking::Reference& reference = tracking::Reference(),
                                      const NgspiceRun& options = {});
/// Without ngspice: the same chain in CVODE, at every tracked frequency.
std::vector<AsBuilt> predict_as_built(const AnalogController& controller,
                                      const tracking::Reference& reference);
/// The worst rms without lag; 0 for none.
double worst_percent(const std::vector<AsBuilt>& cases);

Json to_json(const std::vector<AsBuilt>& cases);
Json to_json(const std::vector<LoopPoint>& loop);

}  // namespace bodesmith::controller
