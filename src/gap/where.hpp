#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "signal/frequency_record.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::gap {

/// A stretch of an axis and the share of the gap (mean square of the residual) that lies in it.
struct Cell {
  std::string axis;  ///< frequency_hz, amplitude, time_s, branch, harmonic
  double from = 0.0;
  double to = 0.0;
  double share = 0.0;
  double extent = 0.0;  ///< share of the record (samples, or band) that the stretch covers
};

/// For each axis the stretch in which the gap is densest (largest share minus extent), kept when it holds at
/// least half of the gap; largest share first. Axes on which the gap is spread evenly are left out, unless
/// all are.
///   frequency_hz  of the residual's spectrum
///   amplitude     of the input
///   time_s        of the record
///   branch        1: input rising, -1: falling, 0: at rest
///   harmonic      of the input's period (only for periodic inputs)
std::vector<Cell> where(const TimeRecord& record, const std::vector<double>& residual, std::size_t from,
                        std::size_t period);
std::vector<Cell> where(const FrequencyRecord& record, const std::vector<double>& residual);

/// Share of the gap in each of `cells` equal stretches of time, for drawings.
std::vector<double> share_over_time(const std::vector<double>& residual, std::size_t cells);

}  // namespace bodesmith::gap
