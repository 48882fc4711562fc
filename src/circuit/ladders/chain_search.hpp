#pragma once

#include <complex>
#include <vector>

#include "circuit/ladders/alternating_chains.hpp"
#include "circuit/ladders/rc_ladder.hpp"
#include "circuit/realise.hpp"
#include "circuit/stages/placement.hpp"

namespace bodesmith::circuit {

/// Values of one chain's parts: its resistor first, then the ladder's.
struct LadderValues {
  std::vector<double> exact, realised;
  /// Every value rounded on its own, at the middle of the levels that the limits leave.
  std::vector<double> nearest;
};

/// An alternating chain drawn as a ladder and a resistor around an op-amp.
class LadderStage {
 public:
  /// Refused when the ladder's values come out negative (ill-conditioned).
  static Outcome<LadderStage> draw(const AlternatingChain& chain, double gain, const RcLadder& ladder);

  /// Searches the values over the grid. `owed`: wanted over realised of the chains before, which this one
  /// makes good as far as it can, and then its own with it. Refused when no level puts all parts between
  /// their limits.
  Outcome<LadderValues> search(const RealiseOptions& options, const std::vector<Hertz>& grid,
                               std::vector<std::complex<double>>& owed) const;

  /// H(s) with ideal op-amps.
  std::complex<double> response(const std::vector<double>& values, RadPerSecond w) const;
  StageDesign design(const LadderValues& values) const;

 private:
  friend class LadderSearch;
  LadderStage(const AlternatingChain& chain, const RcLadder& ladder) : chain_(chain), ladder_(&ladder) {}

  /// |H| up to its sign: Z/R or R/Z.
  std::complex<double> ratio(const std::vector<double>& values, std::complex<double> s) const;
  std::vector<Biquad> factors(const RcImpedance& z, double resistor) const;

  AlternatingChain chain_;
  const RcLadder* ladder_;
  RcImpedance z_;                 ///< with the resistor at 1 ohm
  std::vector<StagePart> parts_;  ///< the resistor first
  std::vector<double> unit_;      ///< values with the resistor at 1 ohm
};

}  // namespace bodesmith::circuit
