#pragma once

#include <map>
#include <string>

#include "part_errors/loop.hpp"

namespace bodesmith::part_errors {

/// Where a loop rests at a point.
struct LoopBias {
  double reference_v = 0.0;  ///< r that makes v
  double slope_v = 0.0;      ///< of the slope meter
  int position = 0;          ///< of the switch
  std::map<std::string, double> volts;
};
LoopBias bias_of(const controller::AnalogController& controller, const LoopPoint& point);

/// The generator's loop at a point, -v for 1 V at what reads it, cut there; 0 where the generator is not fed by its drive.
std::complex<double> generator_loop_gain(const controller::AnalogController& controller,
                                         const LoopPoint& point, RadPerSecond w);

}  // namespace bodesmith::part_errors
