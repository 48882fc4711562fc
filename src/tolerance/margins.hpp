#pragma once

#include <vector>

#include "base/documents/json_fwd.hpp"
#include "lti/loop_margins.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::tolerance {

/// A tuned loop with the circuit as it is built: L = plant times the drawn response.
struct LoopStudy {
  LoopMargins nominal;  ///< of the response that is wanted
  /// Of every circuit, least first. The phase margin nearest to 0 of its crossings (180 without one), below 0 where 1 + L
  /// turns round 0 by another number of turns than the nominal one: its closed loop is not stable where that is.
  std::vector<double> phase_margin_deg;
  /// In size, as gain may be added or lost; circuits whose loop has one.
  std::vector<double> gain_margin_db;
  std::vector<double> max_sensitivity;
  std::uint64_t unstable = 0;
};

/// The same draws as run_monte_carlo(), all of them by this process. `plant` on the grid; between the points of the grid
/// loops go straight (interpolated_loop()).
LoopStudy study_loop(const Design& design, const Options& options, const std::vector<Hertz>& grid,
                     const std::vector<Complex>& plant);

/// What 95 of 100 circuits keep.
double kept_by_95(const std::vector<double>& least_first);

/// `nominal`, and of phase margin, gain margin and sensitivity what half, 95 and all of the circuits keep.
Json to_json(const LoopStudy& study);

}  // namespace bodesmith::tolerance
