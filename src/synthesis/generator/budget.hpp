#pragma once

#include <string>
#include <vector>

#include "synthesis/generator/circuit.hpp"
#include "synthesis/generator/part_errors.hpp"

namespace bodesmith::generator {

/// One cause, alone, by one standard deviation: greatest change of d over x in [0, 1] and the strokes that are looked at, percent of the range
/// of x.
struct BudgetLine {
  std::string cause;
  std::vector<double> percent;  ///< one a branch
};

struct Budget {
  PartErrors errors;
  std::vector<BudgetLine> lines;      ///< of what moves d at all, largest first
  std::vector<double> rss_percent;    ///< root of the sum of squares, one a branch
  std::vector<double> worst_percent;  ///< sum, every cause at its limit
};

Budget make_budget(const DisturbanceCircuit& layout, const PartErrors& errors = {});

}  // namespace bodesmith::generator
