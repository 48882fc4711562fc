#pragma once

#include <optional>
#include <vector>

#include "fpaa/chain_search.hpp"
#include "fpaa/filter_parts.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::fpaa {

/// The CAMs that the parts need, in signal order: each part one, and inverting gain stages (part = -1) where
/// the total sign or a large gain needs them.
struct CamSlot {
  int part = -1;
  bool is_gain() const { return part < 0; }
};
/// `extra` adds that many more gain stages.
std::vector<CamSlot> slots_for(const FilterParts& parts, Band band, int extra = 0);

/// The search problem of these CAMs at a clock.
struct PlanProblem {
  ChainProblem chain;                                  ///< branches in order of the CAMs: above, below
  std::vector<int> first_branch;                       ///< of each CAM; -1 for a biquad
  std::vector<std::optional<BiquadSolution>> biquads;  ///< of each CAM, settled beforehand
  std::vector<double> wanted_gain;                     ///< of each CAM
  bool made = true;                                    ///< false: a biquad cannot be made at this clock
};

/// The gain is spread over the CAMs so that the peak of every node climbs (or falls) evenly, in ratio, from
/// the input to the output.
PlanProblem plan_problem(const FilterParts& parts, const std::vector<CamSlot>& slots, Hertz clock, Band band,
                         int points, int largest_capacitor);

/// The clocks at which every corner can be reached, as a band; empty (from > to) when there is none.
Band reachable_clocks(const FilterParts& parts, int largest_capacitor);

}  // namespace bodesmith::fpaa
