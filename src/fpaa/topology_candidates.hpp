#pragma once

#include <string>
#include <vector>

#include "fpaa/board.hpp"
#include "fpaa/network_fit.hpp"
#include "fpaa/plan.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// How much of the spread by mismatch counts beside the error of the plan itself.
inline constexpr double kMismatchShare = 0.25;

/// A network of some topology, its capacitors whole.
struct TopologyCandidate {
  Network network;
  Network exact;  ///< before its capacitors were whole
  double exact_error = 0.0;
  NetworkScore score;
  std::string topology;
  bool beats = false;     ///< some path samples at a clock within twice the band
  double clipping = 1.0;  ///< clipping_of()
  /// Smaller is better: errors, op-amps, beats and input range counted.
  double rank() const;
};

/// Partial fractions, the cascade, and slow poles behind a cascade of the others or behind a high pass, each with several
/// clocks and sizes of capacitors: fitted, rounded and polished, by rank.
std::vector<TopologyCandidate> topology_candidates(const Sections& sections, Band band,
                                                   const PlanOptions& options, const Board& board);

}  // namespace bodesmith::fpaa
