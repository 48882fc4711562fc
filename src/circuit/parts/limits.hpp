#pragma once

#include "circuit/circuit.hpp"

namespace bodesmith::circuit {

/// Parts that may be used.
struct PartLimits {
  double min_ohm = 1e3;
  double max_ohm = 2.2e6;
  double min_f = 47e-12;
  double max_f = 220e-9;

  /// A value typed as a limit is itself allowed, whatever its last bit.
  bool allow(Part::Kind kind, double value) const {
    const bool resistor = kind == Part::Kind::resistor;
    return value >= (resistor ? min_ohm : min_f) * (1.0 - 1e-9) &&
           value <= (resistor ? max_ohm : max_f) * (1.0 + 1e-9);
  }
  /// Throws InputError where a range is empty.
  void validate() const;
};

}  // namespace bodesmith::circuit
