#pragma once

#include <string>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "schematic/writers/spice_library.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/decks/dialect.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {

/// `.subckt compensator in out`, one subcircuit a stage.
schematic::SpiceLibrary compensator_library(const Circuit& circuit, const std::string& title);

/// Every file of `spice -o DIR` but circuit.json: compensator.sub, parts.csv, the decks of every dialect in
/// dialect_registry(), and the KiCad project compensator.kicad_pro.
void add_compensator_files(const Realised& realised, const std::string& title, OutputSet& out);

/// ngspice against the program's own figures for one circuit.
struct CompensatorCheck {
  Band band;
  ResponseDifference against_network;   ///< ngspice against network_response() with the same op-amp model
  ResponseDifference against_sections;  ///< ngspice against the wanted sections
  double transient_percent =
      0.0;  ///< worst difference of a triangle's answer, percent of its peak, from the program's own (in_time.hpp)
  double noise_percent = 0.0;  ///< worst difference of the output noise density
};

/// Runs compensator_library() through ngspice: small-signal from 1/10 of the lowest to 10 times the highest
/// corner, two periods of a triangle at the middle of the corners, noise over the same band.
CompensatorCheck check_compensator(const Circuit& circuit, const Sections& wanted);

/// "ngspice" of circuit.json.
Json to_json(const CompensatorCheck& check);

}  // namespace bodesmith::synthesis
