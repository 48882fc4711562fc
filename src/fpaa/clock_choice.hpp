#pragma once

#include <vector>

#include "fpaa/clock_tree.hpp"
#include "fpaa/plan_problem.hpp"

namespace bodesmith::fpaa {

/// The clock of a plan and the CAMs' capacitors at that clock.
struct ClockChoice {
  LegalClock clock;
  PlanProblem problem;
  ChainSolution solution;
};

/// The best capacitors at a clock of the tree that the user gave. Refused when the clock is not in the tree
/// or cannot serve the corners or the band, with the clocks that could.
Outcome<ClockChoice> at_given_clock(const TaskChain& chain, Hertz wanted, Band band, const Board& board);

/// The best capacitors at the best clock of the legal tree: many clocks are judged by a quick search for the
/// shape, the best few searched with full effort. Refused when no clock serves all corners.
Outcome<ClockChoice> at_best_clock(const TaskChain& chain, Band band, const Board& board);

}  // namespace bodesmith::fpaa
