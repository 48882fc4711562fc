#pragma once

#include <span>

namespace bodesmith::simulate {

/// How far a simulated output is from a measured one, first seed eq. 8.
struct RecordDifference {
  double rms = 0.0;
  double max = 0.0;
  double rms_percent_of_range = 0.0;  ///< of the measured output's range; 0 for a range of 0
};

/// Both of one length above 0.
RecordDifference compare_records(std::span<const double> simulated, std::span<const double> measured);

/// Height of a hysteresis loop: the largest vertical distance between the rising and the falling branch of y
/// over u, taken on `levels` levels between the extremes of u, in percent of the range of y. 0 when u does
/// not both rise and fall.
double loop_height_percent(std::span<const double> u, std::span<const double> y, int levels = 101);

}  // namespace bodesmith::simulate
