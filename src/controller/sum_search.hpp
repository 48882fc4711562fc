#pragma once

#include <vector>

#include "circuit/parts/series.hpp"

namespace bodesmith::controller {

/// Resistors of a sum with gains of both signs (circuit/parts/summing_amplifier.hpp) for any voltages.
struct SumDesign {
  double feedback = 0.0;
  std::vector<double> wanted, realised;  ///< weights, ohm; 0: the term counts for nothing and is left out
  double balance_wanted = 0.0, balance = 0.0;
  bool balance_at_plus = true;
  std::vector<double> gains;  ///< that the realised resistors make
  double worst_v = 0.0;       ///< greatest |sum g v - target| over the rows
};

/// `rows`: for each point that counts, the voltages of the terms and, last, what the sum should be. Feedback, weights and balance are exchanged
/// for their neighbours in the series while the greatest error over the rows falls; terms that never exceed
/// `least_v` at the output are left out. Throws DesignError, in which `what` names the sum.
SumDesign search_sum(const std::vector<double>& gains, const std::vector<std::vector<double>>& rows,
                     const circuit::Series& series, double least_v, const std::string& what);

}  // namespace bodesmith::controller
