#pragma once

#include <cstddef>
#include <vector>

#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// Designs with a clocked compensator: `per_period` samples of y/stroke a period over whole periods in steady
/// state, from a rising corner on; as many periods as clock and reference need to meet again, at most 20.
///
/// Samples, z-domain filter and hold are worked out edge by edge; the staircase then goes through drive path
/// and stage by matrix exponentials, everything else harmonic by harmonic.
std::vector<double> track_clocked(const Plant& plant, const Design& design, const Options& options,
                                  Hertz frequency, std::size_t per_period);

}  // namespace bodesmith::tracking
