#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace bodesmith::simulate {

/// y over u on evenly spaced levels of u, once while u rises and once while it falls. Levels that u does not
/// cross in both directions are left out. Where u crosses a level several times, the crossings count that lie
/// farthest apart.
struct Loop {
  std::vector<double> u;
  std::vector<double> ascending;
  std::vector<double> descending;
  double height = 0.0;          ///< largest |ascending - descending|
  double height_percent = 0.0;  ///< in percent of the range of y; 0 for a range of 0
};

/// `levels` levels strictly between the extremes of u. u and y of one length, straight lines between samples.
Loop hysteresis_loop(std::span<const double> u, std::span<const double> y, std::size_t levels = 101);

}  // namespace bodesmith::simulate
