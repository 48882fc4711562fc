#pragma once

#include <vector>

#include "yield/design.hpp"

namespace bodesmith::yield {

/// Takes away the frequencies at which the response of one of the designs is 0 (notches, stop bands: less than 1e-9 of its
/// largest on the grid), where deviations in dB, degrees and percent of it are no numbers. Returns them.
std::vector<Hertz> leave_out_nulls(const std::vector<Design>& designs, std::vector<Hertz>& grid);

}  // namespace bodesmith::yield
