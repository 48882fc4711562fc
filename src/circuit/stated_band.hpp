#pragma once

#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::circuit {

/// Where a design is judged: the band in which the sections state their error, else their corners.
Band judged_band(const Sections& sections);

/// Where parts are searched and errors listed: a decade beyond the corners on both sides, but never more than a decade
/// beyond the band in which the sections state their error (a fit may leave a zero at 1 MHz to a curve that ends at
/// 20 kHz). Without corners 1 Hz to 1 kHz.
Band searched_band(const Sections& sections);

}  // namespace bodesmith::circuit
