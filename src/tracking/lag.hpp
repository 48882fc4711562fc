#pragma once

#include <vector>

namespace bodesmith::tracking {

/// Delay of the reference that makes the rms of y - x(t - lag) smallest, and that rms.
struct LagResult {
  double lag_s = 0.0;
  double rms = 0.0;
};
/// Both sampled over `period_s`, after which both repeat.
LagResult best_lag(const std::vector<double>& y, const std::vector<double>& x, double period_s);

}  // namespace bodesmith::tracking
