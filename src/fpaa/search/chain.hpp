#pragma once

#include <optional>

#include "fpaa/search/stage_roots.hpp"
#include "fpaa/search/target.hpp"

namespace bodesmith::fpaa {

/// The clocks of a chain: d0 2^j in whole divisors of the master clock, so that all come from one system divisor.
struct ChainClocks {
  double over_corner = 100.0;  ///< a stage's clock is at least this times its corner …
  double over_band = 10.0;     ///< … and this times the band's upper end, as far as one ratio reaches
  double following =
      1.0;  ///< of `over_band`, for a stage with as many zeros as poles: it follows its input in both phases
  std::optional<std::int64_t> one;  ///< all stages at this divisor of the master clock
  /// Of each stage, where given: how often the clock `one` is halved for it.
  std::vector<int> halvings = {};
  Hertz lowest;   ///< none below
  Hertz highest;  ///< none above
};

/// The divisor of the clock at or above `clock_hz` that others may be halved from: even, beyond one divisor a small number times a power
/// of two.
std::int64_t fastest_divisor(double master_hz, double clock_hz);

/// One path of stages: from the fastest clock to the slowest, and of those alike the one next that keeps the node's magnitude most even;
/// `gains` stages that only invert at the front. Gain as wanted, nodes scaled, capacitors not yet whole. Nothing where a stage
/// cannot be made, or the sign comes out wrong.
struct Chain {
  Design design;
  std::int64_t divisor = 1;   ///< of the fastest clock
  std::vector<int> halvings;  ///< of each stage, in the order of `stages`, after those of the gains
};
std::optional<Chain> chain_design(std::vector<StageRoots> stages, const ChainClocks& clocks, int gains,
                                  const DesignTarget& target);

}  // namespace bodesmith::fpaa
