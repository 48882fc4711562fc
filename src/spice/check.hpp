#pragma once

#include <string>
#include <vector>

#include "circuit/realise.hpp"

namespace bodesmith {

/// ngspice against the program's own figures for one circuit.
struct SpiceCheck {
  Band band;
  ResponseDifference against_network;   ///< ngspice against network_response() with the same op-amp model
  ResponseDifference against_sections;  ///< ngspice against the wanted sections
};

/// Runs compensator_library() through ngspice from 1/10 of the lowest to 10 times the highest corner.
SpiceCheck check_with_ngspice(const Circuit& circuit, const Sections& wanted, int points = 60);

}  // namespace bodesmith
