#pragma once

#include <vector>

#include "base/units.hpp"
#include "lti/sections.hpp"

namespace bodesmith::tracking {

/// w/(s + w): a first-order lag as a path.
Sections lowpass_path(Hertz corner);

/// Disturbance paper, eq. 20, the damping compensator of its nanopositioner's mode at 65.1 kHz (damping_ratio
/// is not printed; choose it so that the damped stage is flat):
///   0.86 (s^2 + 9.854e4 s + 1.67e11)/(s^2 + 1.917e5 s + 1.436e11)
Sections published_damping_compensator();

/// w^2/(s^2 + 2 zeta w s + w^2).
Sections resonance_path(Hertz natural_frequency, double damping_ratio);

/// One behind the other.
Sections in_series(const std::vector<Sections>& paths);

}  // namespace bodesmith::tracking
