#pragma once

#include <vector>

#include "tracking/compensator.hpp"
#include "tracking/reference.hpp"

namespace bodesmith::tracking {

/// What a SlopeGain's slope detector holds over one repeat of the reference, in steady state, evenly sampled.
struct MeasuredSlope {
  std::vector<double> slope;         ///< s, 1/s
  std::vector<double> smoothed;      ///< m, 1/s; |s| without smoothing
  std::vector<double> frequency_hz;  ///< m/(2 alpha)
};
MeasuredSlope measure_slope(const SlopeGain& gain, const Reference& reference, Hertz operating,
                            std::size_t samples);

}  // namespace bodesmith::tracking
