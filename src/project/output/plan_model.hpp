#pragma once

#include <vector>

#include "chain/block.hpp"
#include "fpaa/plan/plan.hpp"

namespace bodesmith::project {

/// A board's chain of CAMs as analog sections, one a CAM under its name.
struct PlanModel {
  std::vector<chain::Block> blocks;
  Band stated;                 ///< the plan's own band
  double worst_percent = 0.0;  ///< |blocks/board - 1| in it (judge_responses)
};

/// The sections start as the bilinear transform, s = 2 fc (z - 1)/(z + 1), of what the capacitors make of samples, and are then fitted
/// to the response of the board as its switches make it, whose stages follow their inputs within a phase: all their
/// gains and roots at once, in least squares of relative errors (FactoredResponse), from a tenth of the plan's band to its end or a
/// quarter of the slowest clock, whichever is higher. A zero at 0 stays there. A delay (GainHalf and Hold have one) is a
/// block of its own, where the sections alone are further from the board than the board is from what was asked.
/// Images of the clocks are not in it. Throws DesignError for a plan that is no chain.
PlanModel plan_model(const fpaa::Plan& plan);

}  // namespace bodesmith::project
