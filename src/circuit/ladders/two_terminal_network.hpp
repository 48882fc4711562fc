#pragma once

#include <complex>
#include <string>
#include <vector>

#include "base/units.hpp"

namespace bodesmith::circuit {

struct TwoTerminalPart {
  bool resistor = true;
  std::string from, to;
  double value = 0.0;
};

/// Impedance of an RC network between two of its nodes, by nodal analysis.
std::complex<double> impedance_between(const std::vector<TwoTerminalPart>& parts, const std::string& a,
                                       const std::string& b, RadPerSecond w);

}  // namespace bodesmith::circuit
