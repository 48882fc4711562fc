#pragma once

#include <string>

#include "base/files.hpp"
#include "schematic/writers/spice_library.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/decks/dialect.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::spice {

/// `.subckt compensator in out`, one subcircuit a stage.
schematic::SpiceLibrary compensator_library(const circuit::Circuit& circuit, const std::string& title);

/// Every file of `spice -o DIR` but circuit.json: compensator.sub, parts.csv, the decks of every dialect in
/// dialect_registry(), and the KiCad project compensator.kicad_pro.
void add_compensator_files(const circuit::Realised& realised, const std::string& title, OutputSet& out,
                           const MonteCarloOptions& monte_carlo = {});

}  // namespace bodesmith::spice
