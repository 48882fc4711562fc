#pragma once

#include <string>

#include "base/outcome.hpp"
#include "fpaa/board.hpp"
#include "fpaa/mismatch.hpp"
#include "fpaa/network_fit.hpp"
#include "fpaa/plan.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// A network that was searched, on the board.
struct SearchedNetwork {
  Network network;
  NetworkScore score;
  std::string topology;  ///< "parallel", "cascade", "cascade and parallel"
  Plan plan;             ///< chips, places, wires
  double rank = 0.0;     ///< smaller is better: errors, op-amps, beats, input range, noise and chips counted
  bool beats = false;    ///< some path samples at a clock within twice the band
};

/// Tries partial fractions (every pole a path at its own clock, fewer paths where fewer do), the cascade at one
/// clock, and slow poles as paths behind a cascade of the others; each with several clocks and sizes of
/// capacitors, fitted as the board runs, rounded to whole capacitors; keeps the one with the smallest error
/// that 95 % of boards keep. Where that one samples within the band and is not good, all is tried again with every clock
/// above the band. Refused when none can be built.
Outcome<SearchedNetwork> search_topology(const Sections& sections, Band band, const PlanOptions& options,
                                         const Board& board);

}  // namespace bodesmith::fpaa
