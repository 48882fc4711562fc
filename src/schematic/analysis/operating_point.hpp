#pragma once

#include <map>
#include <stdexcept>
#include <string>

#include "schematic/deviations.hpp"

namespace bodesmith::schematic {

/// A circuit whose voltages at rest were not found.
class NoOperatingPoint : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// V of every node at rest from the equations of all elements at once, by Newton's method on f(x) = 0: op-amps are nullors,
/// diodes ideal, capacitors open, the contacts of one position closed. `inputs`: V of nodes driven from outside; `start`: V
/// from which to begin. What RestPoint compiles, slowly. Throws NoOperatingPoint.
std::map<std::string, double> operating_point(const Netlist& netlist,
                                              const std::map<std::string, double>& inputs, int position,
                                              const Deviations& off,
                                              const std::map<std::string, double>& start = {});

}  // namespace bodesmith::schematic
