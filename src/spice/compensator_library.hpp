#pragma once

#include <string>

#include "base/files.hpp"
#include "circuit/circuit.hpp"
#include "circuit/realise.hpp"
#include "schematic/writers/spice_library.hpp"
#include "spice/dialect.hpp"

namespace bodesmith::spice {

/// `.subckt compensator in out`, one subcircuit a stage.
schematic::SpiceLibrary compensator_library(const circuit::Circuit& circuit, const std::string& title);

/// Every file of `spice -o DIR` but circuit.json: compensator.sub, parts.csv, and the decks of every dialect
/// in dialect_registry().
void add_spice_files(const circuit::Realised& realised, const std::string& title, OutputSet& out,
                     const MonteCarloOptions& monte_carlo = {});

}  // namespace bodesmith::spice
