#pragma once

#include <optional>
#include <vector>

#include "tracking/periodic.hpp"
#include "tracking/tracking.hpp"

namespace bodesmith::tracking {

/// Samples of y/stroke over `periods` whole periods in steady state, `per_period` of each, from a rising
/// corner on.
struct TimeTracking {
  std::vector<double> displacement;
  int per_period = 0;
  int periods = 1;
};

/// Continuous designs: one period in CVODE, from the exact periodic state, restarted at the reference's
/// corners (and, for the drive as argument, where the drive turns). Nothing when the design has a part with
/// no time domain (a response without approximation, a clocked compensator with hold).
std::optional<TimeTracking> track_in_cvode(const TrackingPlant& plant, const TrackingDesign& design,
                                           const TrackingOptions& options, Hertz frequency, int per_period);

/// Designs with a clocked compensator: samples, z-domain filter and hold worked out edge by edge; the
/// staircase then goes through drive path and stage by matrix exponentials, everything else harmonic by
/// harmonic.
TimeTracking track_clocked(const TrackingPlant& plant, const TrackingDesign& design,
                           const TrackingOptions& options, Hertz frequency, int per_period);

/// A clocked compensator that is worked out edge by edge.
bool is_clocked(const Compensator& compensator);

}  // namespace bodesmith::tracking
