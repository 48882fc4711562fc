#pragma once

#include <optional>
#include <vector>

#include "simulate/types.hpp"

namespace bodesmith::simulate {

/// u = f + control(r - y), y = P{u}: a feed-forward signal and the loop round the plant, as the disturbance
/// paper's hybrid controllers. r and f are straight lines between samples.
struct LoopResult {
  std::vector<double> y;
  std::vector<double> drive;  ///< u; at a clock edge of a sampled controller its new value
  std::optional<double> error_estimate;
  double model_error = 0.0;  ///< as in Result
  Stats stats;
};

}  // namespace bodesmith::simulate
