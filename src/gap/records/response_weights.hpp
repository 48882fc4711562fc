#pragma once

#include <optional>
#include <vector>

#include "signal/bode_points.hpp"

namespace bodesmith::gap {

// With the coherence g = gamma^2 of n averages, a measured point of a response has the variance
//     |H|^2 (1 - g)/(2 n g)
// in each of the real and imaginary part (J. S. Bendat and A. G. Piersol, Random Data, 2010, table 9.6: of gain, and of
// phase in rad).

/// One factor a point for residuals relative to |H|: the inverse of that deviation, the mean of the squares 1. A coherence of 1 is a
/// rounded one: none is taken to be above .9999.
/// Empty for a record without coherence.
std::vector<double> response_weights(const FrequencyRecord& record);

/// What noise leaves of residuals so weighted (rms of a part), where the record says over how many averages.
std::optional<double> noise_by_coherence(const FrequencyRecord& record);

}  // namespace bodesmith::gap
