#pragma once

#include <span>

namespace bodesmith {

/// By how many deviations of chance a power spectrum (signal/periodogram.hpp) differs from the nearest
///     S(f) = w + a/(1 + (f/f0)^p),   w, a >= 0,  p = 1, 1.5 or 2,
/// as noise has it that is white, forgets itself exponentially (p = 2, red) or falls as 1/f, and any of these over a white floor.
/// Means over bands that widen by a quarter are compared, by Whittle's likelihood (J. Roy. Statist. Soc. B 15 (1953) 125): the
/// deviance of all bands beyond their number, over its standard deviation. A band of its own, a steep edge or a line is far
/// from it. 0 for fewer than 12 bands.
double deviations_from_slow_noise(std::span<const double> power);

}  // namespace bodesmith
