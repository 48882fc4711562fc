#pragma once

namespace bodesmith::circuit {

/// What is bought: the classes of parts written into Monte Carlo decks and the schematic.
struct Tolerances {
  double resistor_percent = 1.0;
  double capacitor_percent = 5.0;
};

}  // namespace bodesmith::circuit
