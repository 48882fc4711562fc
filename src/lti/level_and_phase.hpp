#pragma once

#include <complex>
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

}  // namespace bodesmith
