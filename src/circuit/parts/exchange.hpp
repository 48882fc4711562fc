#pragma once

#include "circuit/parts/candidates.hpp"

namespace bodesmith::circuit {

/// One candidate of every stage so that max. |sum of the stages' errors| over the grid is small: descent by
/// one stage at a time from up to 24 starts (deterministic). The best `count` ends, each once, best first, as
/// places in `all`.
std::vector<std::vector<std::size_t>> best_choices(const std::vector<std::vector<StageCandidate>>& all,
                                                   std::size_t count);

}  // namespace bodesmith::circuit
