#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "lti/sections.hpp"

namespace bodesmith {

/// How far an open loop L(jw) is from making its closed loop 1/(1 + L) unstable.
struct LoopMargins {
  struct GainCrossing {  ///< |L| = 1
    Hertz frequency;
    double phase_margin_deg = 0.0;  ///< 180 degrees + arg L, in (-180, 180]
    double delay_margin_s = 0.0;    ///< the delay that turns L to -1 there
  };
  struct PhaseCrossing {  ///< L real and below 0
    Hertz frequency;
    double gain_margin_db = 0.0;  ///< -20 lg |L|: below 0 where L is beyond -1
  };
  std::vector<GainCrossing> gain_crossings;
  std::vector<PhaseCrossing> phase_crossings;
  /// Largest |1/(1 + L)|, the reciprocal of the distance from -1, over the grid's band.
  double max_sensitivity = 0.0;
  Hertz max_sensitivity_at;
  Complex lowest;          ///< L at the lowest frequency
  bool encircles = false;  ///< 1 + L turns by more than half a turn round 0 over the grid

  /// The crossing nearest to instability; null without crossings.
  const GainCrossing* least_phase_margin() const;
  const PhaseCrossing* least_gain_margin() const;
  /// Of an L that is stable by itself and finite at rest: the least |phase margin|, below 0 where 1 + L goes round 0
  /// (unstable); 180 without a crossing.
  double phase_margin_deg() const;
  /// By how much such a loop's gain may grow until L reaches -1 (below 0: it is beyond), an L below 0 at rest counted;
  /// nothing where it may grow without end.
  std::optional<double> gain_margin_db() const;
};

using Loop = std::function<Complex(Hertz)>;

/// A loop known at some frequencies: between them ln |L| and its phase go straight over ln f.
Loop interpolated_loop(std::vector<Hertz> grid, std::vector<Complex> values);

/// Crossings of |L| = 1 between neighbours of the rising grid, found to 1e-12 of their frequency; two within one step where the
/// loop shows at the grid's points that it turns back there.
std::vector<LoopMargins::GainCrossing> gain_crossings(const Loop& loop, const std::vector<Hertz>& grid);

/// `gain_crossings`, `phase_crossings`, `max_sensitivity`, `max_sensitivity_hz`.
Json to_json(const LoopMargins& margins);

/// All of them, crossings as gain_crossings() finds them.
LoopMargins loop_margins(const Loop& loop, const std::vector<Hertz>& grid);
/// The same of data, see interpolated_loop().
LoopMargins loop_margins(const std::vector<Hertz>& grid, const std::vector<Complex>& values);

/// Whether 1/(1 + L) is stable, by the turns of 1 + L(jw) round 0 (Nyquist), for L without poles in the right half
/// plane. Nothing when L has such poles, or runs through -1.
std::optional<bool> closed_loop_is_stable(const Sections& loop);

}  // namespace bodesmith
