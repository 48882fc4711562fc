#pragma once

#include <vector>

#include "base/units.hpp"
#include "lti/sections.hpp"

namespace bodesmith::tracking {

/// w/(s + w): a first-order lag as a path.
Sections lowpass_path(Hertz corner);

/// w^2/(s^2 + 2 zeta w s + w^2).
Sections resonance_path(Hertz natural_frequency, double damping_ratio);

/// One behind the other.
Sections in_series(const std::vector<Sections>& paths);

}  // namespace bodesmith::tracking
