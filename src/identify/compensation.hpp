#pragma once

#include <cstddef>
#include <vector>

#include "identify/stage_model.hpp"

namespace bodesmith::identify {

/// The drive that makes the stage follow a reference, and how well it can.
struct Compensation {
  std::vector<double> drive;
  std::vector<double> predicted;  ///< the model's output under the drive, delay included
  std::size_t out_of_reach = 0;   ///< samples whose reference the model cannot reach
};
/// Inverts the static and hysteretic parts exactly. A delay is made good by looking ahead in the reference
/// when `preview` is set, otherwise it stays in the predicted output. Throws DesignError when the model has no
/// inverse.
Compensation compensate(const StageModel& stage, const std::vector<double>& reference, double step_s,
                        bool preview);

}  // namespace bodesmith::identify
