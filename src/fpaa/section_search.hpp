#pragma once

#include <complex>
#include <vector>

#include "base/units.hpp"
#include "fpaa/cams/filter_bilinear.hpp"

namespace bodesmith::fpaa {

/// The best capacitors of one pole-zero CAM by itself, proven: no other set of 1 ... max_capacitor units has
/// a smaller worst complex error min over g of max over grid |g H(jw)/S(jw) - 1|, S = (1 + jw/zero)/(1 +
/// jw/pole). The gain g is free because the cascade carries it elsewhere.
struct SectionOptimum {
  PoleZeroCapacitors capacitors;
  double max_complex_error = 0.0;
  double free_gain = 1.0;  ///< g at the optimum
  long evaluated = 0;      ///< sets whose error was computed
  double sets = 0.0;       ///< sets there are (distinct ratios squared); the rest were excluded by bounds
};

/// Branch and bound over the pole's capacitor ratios. The bound: an error of at most E keeps the phase of H/S
/// within asin E at every frequency, which confines the zero's ratio to an interval for a whole interval of
/// pole ratios; where the intervals of all frequencies do not meet, no set in there can be better.
SectionOptimum best_pole_zero(RadPerSecond zero, RadPerSecond pole, Hertz clock,
                              const std::vector<RadPerSecond>& grid, int max_capacitor = 255);

/// min over g > 0 of max |g q - 1| (exact up to rounding), and that g.
struct FreeGain {
  double error = 0.0;
  double gain = 1.0;
};
FreeGain best_free_gain(const std::vector<std::complex<double>>& q);

}  // namespace bodesmith::fpaa
