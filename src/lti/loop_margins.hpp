#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <vector>

#include "base/json_fwd.hpp"
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

  /// The crossing nearest to instability; null without crossings.
  const GainCrossing* least_phase_margin() const;
  const PhaseCrossing* least_gain_margin() const;
};

using Loop = std::function<std::complex<double>(Hertz)>;

/// `gain_crossings`, `phase_crossings`, `max_sensitivity`, `max_sensitivity_hz`.
Json to_json(const LoopMargins& margins);

/// Crossings between neighbours of the rising grid, found to 1e-12 of their frequency; two crossings within one step
/// of the grid are missed.
LoopMargins loop_margins(const Loop& loop, const std::vector<Hertz>& grid);

/// Whether 1/(1 + L) is stable, by the turns of 1 + L(jw) round 0 (Nyquist), for L without poles in the right half
/// plane. Nothing when L has such poles, or runs through -1.
std::optional<bool> closed_loop_is_stable(const Sections& loop);

}  // namespace bodesmith
