#pragma once

namespace bodesmith {

/// Tolerances written into the Monte Carlo decks and the schematic.
struct DeckTolerances {
  double resistor_percent = 1.0;
  double capacitor_percent = 5.0;
  int runs = 100;
  unsigned seed = 1;
};

}  // namespace bodesmith
