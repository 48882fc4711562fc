#pragma once

#include <string>

#include "circuit/circuit.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::spice {

/// `.subckt compensator in out`, one subcircuit a stage.
schematic::SpiceLibrary compensator_library(const circuit::Circuit& circuit, const std::string& title);

}  // namespace bodesmith::spice
