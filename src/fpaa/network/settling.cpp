#include "fpaa/network/settling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodesmith::fpaa {
namespace {

const PlateNode& in_phase(const Plate& plate, int phase) {
  return phase == 1 ? plate.phase1 : plate.phase2;
}

/// What hangs at an op-amp's inverting input in one phase.
struct AtInput {
  double beta = 1.0;  ///< 1 where the feedback switch is closed
  double largest_units = 0.0;
};

AtInput at_input(const StageSwitches& stage, int opamp, int phase) {
  AtInput out;
  double all = 0.0;
  double feedback = 0.0;
  for (const StageCapacitor& c : stage.capacitors) {
    if (in_phase(c.far, phase) != PlateNode::virtual_ground(opamp)) continue;
    const PlateNode& near = in_phase(c.near, phase);
    if (near.kind == PlateNode::Kind::open) continue;
    out.largest_units = std::max(out.largest_units, c.units);
    all += c.units;
    if (near == PlateNode::opamp(opamp)) feedback += c.units;
  }
  const bool is_reset = stage.opamps[static_cast<std::size_t>(opamp - 1)].reset_phase == phase;
  if (!is_reset && all > 0.0) out.beta = std::max(feedback / all, 1e-9);
  return out;
}

}  // namespace

Unsettled unsettled(const StageSwitches& stage, const SlowParts& parts, Hertz clock) {
  Unsettled out;
  for (int k = 1; k <= static_cast<int>(stage.opamps.size()); ++k) {
    for (const int phase : {1, 2}) {
      const AtInput at = at_input(stage, k, phase);
      double tau = 2.0 * parts.switch_s * at.largest_units;
      if (!parts.opamp.is_ideal) {
        tau += 1.0 / (2.0 * std::numbers::pi * at.beta * parts.opamp.gain_bandwidth.value);
        out.by_gain = std::max(out.by_gain, 1.0 / (at.beta * parts.opamp.dc_gain));
      }
      if (tau > 0.0) out.moving = std::max(out.moving, std::exp(-0.5 / (clock.value * tau)));
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
