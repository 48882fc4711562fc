#pragma once

#include <vector>

#include "yield/yield.hpp"

namespace bodesmith::yield {

/// d ln H/d ln part of a design, and how far each part may be off: ranges, worst case and ranking without
/// chance.
struct Sensitivity {
  std::vector<std::vector<double>> db_per_percent;  ///< [part][frequency]; 0 at a null of the response
  std::vector<std::vector<double>> deg_per_percent;
  std::vector<double> limit_percent;  ///< of each part (three standard deviations where there is no limit)
};
Sensitivity sensitivity_of(const Design& design, const Options& options);

}  // namespace bodesmith::yield
