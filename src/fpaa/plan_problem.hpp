#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fpaa/chain_search.hpp"
#include "fpaa/split_sections.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::fpaa {

/// The tasks and as many gain stages (last in the path) as the total sign or a large gain needs, and
/// `extra` more.
TaskChain with_gain_stages(TaskChain chain, Band band, std::size_t extra = 0);

/// The search problem of these tasks at a clock.
struct PlanProblem {
  ChainProblem chain;  ///< branches in order of the tasks
  /// Of each task: its first branch; nothing for one that is settled by itself.
  std::vector<std::optional<std::size_t>> first_branch;
  std::vector<std::optional<PlacedCam>> settled;  ///< of each task that is settled by itself
  std::vector<double> wanted_gain;                ///< of each task
};

/// The gain is spread over the CAMs so that the peak of every node climbs (or falls) evenly, in ratio, from
/// the input to the output. Nothing when a task cannot be settled at this clock.
std::optional<PlanProblem> plan_problem(const TaskChain& chain, Hertz clock, Band band, int points,
                                        int max_capacitor);

/// The CAMs that solve it, in signal order.
std::vector<PlacedCam> realised_cams(const TaskChain& chain, const PlanProblem& problem,
                                     const ChainSolution& solution);

/// The clocks at which every task can be done, as a band; empty (from > to) when there is none.
Band possible_clocks(const TaskChain& chain, int max_capacitor);

}  // namespace bodesmith::fpaa
