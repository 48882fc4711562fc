#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// Continuous designs: `samples` of y/stroke over one period in steady state, from a rising corner on, by
/// CVODE from the exact periodic state, restarted at the reference's corners (and, for the drive as argument,
/// where the drive turns). Nothing when the design has a part with no time domain (a response without
/// approximation, a clocked compensator).
std::optional<std::vector<double>> track_continuous(const Plant& plant, const Design& design,
                                                    const Options& options, Hertz frequency,
                                                    std::size_t samples);

}  // namespace bodesmith::tracking
