#pragma once

#include <vector>

#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// Every design at every frequency. InputError: no frequency, or one that is not above 0 Hz; an amplitude or
/// stroke not above 0; a schedule without rows; a clock not above 0 Hz. DesignError: a generator fed by its own
/// drive that does not settle.
Report track(const Plant& plant, const std::vector<Design>& designs, const Options& options);

}  // namespace bodesmith::tracking
