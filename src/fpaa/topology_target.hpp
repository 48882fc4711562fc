#pragma once

#include <vector>

#include "fpaa/board.hpp"
#include "fpaa/clock_features.hpp"
#include "fpaa/network.hpp"
#include "fpaa/network_parallel.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// What the search minimises on: the band, and with a quarter of the weight up to fifty times its upper end (the
/// board goes on working above the band), as far as the fast clock is sixteen times the frequency.
NetworkTarget network_target(const Sections& sections, Band band, double fast_clock_hz, const Board& board);

/// A closer grid, and points beside the multiples of slow clocks: held outputs have narrow features there.
NetworkTarget seen_closer(NetworkTarget target, const Network& network, const Sections& sections);

/// Some points beside the clocks within the band, for the fit.
NetworkTarget with_clocks_seen(NetworkTarget target, const std::vector<ClockedPole>& poles,
                               const Sections& sections);

std::vector<ClockedPole> clocked_poles(const std::vector<ParallelPath>& paths, double master_hz);

}  // namespace bodesmith::fpaa
