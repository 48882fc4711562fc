#pragma once

#include <cstddef>
#include <vector>

#include "tracking/periodic.hpp"
#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// Designs with a clocked compensator and one pass of the generator: `per_repeat` samples of y/stroke a repeat over
/// whole repeats in steady state, from the reference's phase 0 on; as many repeats as clock and reference need to
/// meet again, at most 20.
///
/// Samples, z-domain filter and hold are worked out edge by edge; the staircase goes through the drive path by
/// matrix exponentials, and the stage reads what comes out, sample by sample. A step of the staircase lasts no
/// time between two samples: it turns no branch.
std::vector<double> track_clocked(const Plant& plant, const Design& design, const Options& options,
                                  const PeriodicTracking& periodic, std::size_t per_repeat);

}  // namespace bodesmith::tracking
