#pragma once

#include <vector>

#include "base/units.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {

/// Where a chain's errors are looked at while its parts are searched, and what each counts: 1, or on a flank, where the
/// chain changes faster than kFlankRate, as much less (lti/judge_responses.hpp, to first order). Points below kJudgedFloor of
/// the largest magnitude are not in it: next to a zero on the axis no parts do well.
struct SearchGrid {
  std::vector<Hertz> at;
  std::vector<double> weight;

  /// `count` frequencies, and more where the response has flanks.
  SearchGrid(const Sections& wanted, Band band, int count);
};

/// What a stage with given parts makes of its own wanted response, along the grid of a search.
class StageErrors {
 public:
  StageErrors(const StageForm& form, const SearchGrid& grid);

  /// ln(H/H_wanted) in nepers and radians, weighted.
  std::vector<Complex> logarithms(const std::vector<double>& values) const;
  /// Max. |H/H_wanted - 1|^2, weighted; stops looking once it is above `enough`.
  double worst_square(const std::vector<double>& values, double enough) const;

 private:
  const StageForm& form_;
  std::vector<double> w_;  ///< rad/s
  std::vector<double> weight_;
  std::vector<Complex> wanted_;
};

}  // namespace bodesmith::synthesis
