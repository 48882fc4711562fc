#include "fpaa/network/settling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodesmith::fpaa {
namespace {

const PlateNode& in_phase(const Plate& plate, int phase) {
  return phase == 1 ? plate.phase1 : plate.phase2;
}

/// 1 where the feedback switch is closed.
double feedback_share(const StageSwitches& stage, int opamp, int phase) {
  if (stage.opamps[static_cast<std::size_t>(opamp - 1)].reset_phase == phase) return 1.0;
  double all = 0.0;
  double feedback = 0.0;
  for (const StageCapacitor& c : stage.capacitors) {
    if (in_phase(c.far, phase) != PlateNode::virtual_ground(opamp)) continue;
    const PlateNode& near = in_phase(c.near, phase);
    if (near.kind == PlateNode::Kind::open) continue;
    all += c.units;
    if (near == PlateNode::opamp(opamp)) feedback += c.units;
  }
  return all > 0.0 ? feedback / all : 1.0;
}

}  // namespace

double unsettled_share(const StageSwitches& stage, const schematic::OpAmpModel& opamp, Hertz clock) {
  double out = 0.0;
  for (int k = 1; k <= static_cast<int>(stage.opamps.size()); ++k) {
    for (const int phase : {1, 2}) {
      const double beta = std::max(feedback_share(stage, k, phase), 1e-9);
      const double left = std::exp(-std::numbers::pi * beta * opamp.gain_bandwidth.value / clock.value);
      out = std::max(out, left + 1.0 / (beta * opamp.dc_gain));
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
