#pragma once

#include <vector>

#include "base/error.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/search/score.hpp"

namespace bodesmith::fpaa {

/// A plan without its figures.
struct FoundPlan {
  Plan plan;
  bool vendor = false;  ///< AnadigmDesigner2 has all its CAMs
};

/// Chains with several clocks, numbers of stages and pairings, by rising care: fitted with any capacitors and judged by what whole
/// ones could come to at best (mismatch, swing); the most promising made whole; the best of these with more care.
/// Returned are the best by figures of first order in each capacitor, then (not of a quick search) all that no other one beats
/// in both, error and input. Refused with what is missing when none fits on the board.
Outcome<std::vector<FoundPlan>> search_design(const Sections& sections, Band band, const PlanOptions& options,
                                              const Board& board);

}  // namespace bodesmith::fpaa
