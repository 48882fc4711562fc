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

/// Takes out those whose generator, fed by its own drive, does not settle at one of the frequencies; returns why, one sentence each.
std::vector<std::string> take_out_unsettled(const tracking::Plant& plant, tracking::Options options,
                                            std::vector<TrackedCandidate>& candidates);

/// What became of it.
TrackedDesign tracked_design(const TrackedCandidate& candidate, const std::vector<Hertz>& frequencies,
                             const tracking::Report& report);

}  // namespace bodesmith::project
