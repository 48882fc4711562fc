#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "lti/sections.hpp"

namespace bodesmith {

/// A response along a grid as a Bode plot shows it.
struct LevelAndPhase {
  std::vector<double> magnitude_db;
  std::vector<double> phase_deg;  ///< without jumps of more than half a turn from one frequency to the next
};
LevelAndPhase level_and_phase(std::span<const std::complex<double>> response);
/// Of sections, without keeping the responses in between.
LevelAndPhase level_and_phase(const Sections& sections, const std::vector<Hertz>& grid);

/// Group delay -d(arg H)/dw in seconds. Of sections in closed form, sum Re 1/(jw - p) - sum Re 1/(jw - z) + delay.
double group_delay_s(const Sections& sections, RadPerSecond w);
/// Of any response by a central difference over 2e-4 of the frequency (relative error about 1e-8 where H is smooth).
double group_delay_s(const std::function<std::complex<double>(Hertz)>& response, Hertz f);

}  // namespace bodesmith
