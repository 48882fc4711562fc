#pragma once

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

/// The search problem of these CAMs at a clock: branches in the order above, below of each CAM, and the gain
/// spread over the CAMs so that the peak of every node climbs (or falls) evenly, in ratio, from the input to
/// the output.
ChainProblem chain_problem(const FilterParts& parts, const std::vector<CamSlot>& slots, Hertz clock,
                           Band band, int points);

/// The clocks at which every corner can be reached, as a band; empty (from > to) when there is none.
Band reachable_clocks(const FilterParts& parts, int largest_capacitor);

}  // namespace bodesmith::fpaa
