#pragma once

#include <complex>
#include <vector>

#include "base/units.hpp"
#include "circuit/parts/search_grid.hpp"
#include "circuit/stages/stage_form.hpp"

namespace bodesmith::circuit {

/// What a stage with given parts makes of its own wanted response, along the grid of a search.
class StageErrors {
 public:
  StageErrors(const StageForm& form, const SearchGrid& grid);

  /// ln(H/H_wanted) in nepers and radians, weighted.
  std::vector<std::complex<double>> logarithms(const std::vector<double>& values) const;
  /// Max. |H/H_wanted - 1|^2, weighted; stops looking once it is above `enough`.
  double worst_square(const std::vector<double>& values, double enough) const;

 private:
  const StageForm& form_;
  std::vector<double> w_;  ///< rad/s
  std::vector<double> weight_;
  std::vector<std::complex<double>> wanted_;
};

}  // namespace bodesmith::circuit
