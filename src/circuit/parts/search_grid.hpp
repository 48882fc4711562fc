#pragma once

#include <vector>

#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::circuit {

/// Where a chain's errors are looked at while its parts are searched, and what each counts: 1, or on a flank, where the
/// chain changes faster than kFlankRate, as much less (lti/steep_flanks.hpp, to first order). Points below kJudgedFloor of
/// the largest magnitude are not in it: next to a zero on the axis no parts do well.
struct SearchGrid {
  std::vector<Hertz> at;
  std::vector<double> weight;

  /// `count` frequencies, and more where the response has flanks.
  SearchGrid(const Sections& wanted, Band band, int count);
};

}  // namespace bodesmith::circuit
