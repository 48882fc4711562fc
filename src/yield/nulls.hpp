#pragma once

#include <vector>

#include "yield/design.hpp"

namespace bodesmith::yield {

/// Takes away the frequencies at which the response of one of the designs is below kJudgedFloor of its largest on the grid
/// (notches, stop bands): deviations in dB, degrees and percent say nothing there. Returns them.
std::vector<Hertz> leave_out_nulls(const std::vector<Design>& designs, std::vector<Hertz>& grid);

}  // namespace bodesmith::yield
