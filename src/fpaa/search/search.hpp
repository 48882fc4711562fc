#pragma once

#include <string>

#include "base/error.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/search/score.hpp"

namespace bodesmith::fpaa {

/// Chains with several clocks, numbers of stages and pairings, by rising care: fitted with any capacitors and judged by what whole
/// ones could come to at best (mismatch, swing); the most promising made whole; the best of these with more care.
/// Refused with what is missing when none fits on the board.
Outcome<Plan> search_design(const Sections& sections, Band band, const PlanOptions& options,
                            const Board& board);

}  // namespace bodesmith::fpaa
