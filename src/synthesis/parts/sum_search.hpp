#pragma once

#include <vector>

#include "synthesis/parts/series.hpp"

namespace bodesmith::circuit {

/// Resistors of an inverting sum for any voltages.
struct SumDesign {
  double feedback = 0.0;
  std::vector<double> wanted, realised;  ///< weights, ohm; 0: the term counts for nothing and is left out
  std::vector<double> gains;             ///< that the realised resistors make
};

/// For gains below 0. `rows`: for each point that counts, the voltages of the terms and, last, what the sum should be. Feedback and weights are
/// exchanged for their neighbours in the series while the greatest error over the rows falls; terms that never exceed
/// `least_v` at the output are left out. Throws DesignError, in which `what` names the sum.
SumDesign search_sum(const std::vector<double>& gains, const std::vector<std::vector<double>>& rows,
                     const Series& series, double least_v, const std::string& what);

}  // namespace bodesmith::circuit
