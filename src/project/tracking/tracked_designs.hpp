#pragma once

#include <optional>
#include <string>
#include <vector>

#include "project/design/design.hpp"
#include "project/project.hpp"
#include "project/tracking/tracking_study.hpp"
#include "tracking/types.hpp"

namespace bodesmith::project {

/// A way of compensating as the tracking simulation takes it, and its column.
struct TrackedCandidate {
  std::string key;     ///< see tracked:: in tracking_study.hpp
  bool built = false;  ///< made of what the run writes
  int parts = 0;       ///< op-amps and multipliers it takes, for ties
  tracking::Design design;
};

/// Without compensation and the disturbance paper's one pass: constant polynomial, then every stage from the ideal
/// cascade to the hardware, the best waveform fit and a gain scheduled by the measured frequency. Then what more than
/// one pass does: two passes, and the generator fed by its own drive with no rate compensation, with the sections as
/// designed and as built, and with gains by the known frequency, by the measured slope, and alongside the filter.
std::vector<TrackedCandidate> tracked_candidates(const Project& project, const Design& design);

/// What became of it.
TrackedDesign tracked_design(const TrackedCandidate& candidate, const std::vector<Hertz>& frequencies,
                             const tracking::Report& report);

}  // namespace bodesmith::project
