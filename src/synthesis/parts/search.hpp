#pragma once

#include <memory>
#include <string>
#include <vector>

#include "synthesis/parts/stage_errors.hpp"
#include "synthesis/realisation.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {

/// Values of every stage's parts, searched jointly.
struct PartsFound {
  std::vector<std::vector<double>> values;  ///< a stage each, in the order of its form's parts()
  double worst_complex_percent = 0.0;       ///< of the whole chain, over the grid, weighted
};

/// For every stage a few hundred combinations of preferred capacitors and neighbouring preferred resistors
/// (candidates.hpp), then the choice among them for all stages together by exchange, then
/// single parts, for the least max. |H/H_wanted - 1| of the chain: one stage's gain error is made
/// good by another's. Deterministic. Refused when a stage's corner is out of reach of the allowed parts.
Outcome<PartsFound> search_parts(const std::vector<std::unique_ptr<StageForm>>& forms,
                                 const std::vector<std::string>& titles, const RealiseOptions& options,
                                 const SearchGrid& grid);

}  // namespace bodesmith::synthesis
