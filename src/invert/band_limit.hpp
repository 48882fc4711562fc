#pragma once

#include <vector>

#include "base/units.hpp"

namespace bodesmith::invert {

/// The signal without what lies above the bandwidth: nothing is late (no phase), gain 1 up to 0.8 of it and then
/// down as a raised cosine; the record is continued by its reflection in its end points.
std::vector<double> band_limited(const std::vector<double>& u, double step_s, Hertz bandwidth);

}  // namespace bodesmith::invert
