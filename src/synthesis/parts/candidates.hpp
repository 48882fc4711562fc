#pragma once

#include <cstddef>
#include <vector>

#include "synthesis/parts/stage_errors.hpp"
#include "synthesis/realisation.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {

/// Values for one stage's parts.
struct StageCandidate {
  std::vector<double> values;
  std::vector<Complex> error;  ///< ln(H/H_wanted) of this stage over the grid, weighted
  double rank = 0.0;
};

/// Max. |error|^2.
double worst_square(const std::vector<Complex>& error);

/// Up to 400 of them, best first: those of the preferred capacitors within a decade from the smallest that
/// keep the resistors within their limits, with neighbouring preferred resistors. Among several stages a
/// constant gain error does not count: another stage makes it good. Empty when the limits allow none.
std::vector<StageCandidate> stage_candidates(const StageForm& form, const RealiseOptions& options,
                                             const SearchGrid& grid, std::size_t stages);

}  // namespace bodesmith::synthesis
