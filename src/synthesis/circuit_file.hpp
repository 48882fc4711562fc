#pragma once

#include "base/documents/document.hpp"
#include "base/documents/json_fwd.hpp"
#include "lti/frequency_grid.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/opamp_check.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {

/// A circuit.json (`bodesmith.circuit/1`) read back: the circuit that was made, its parts as they are mounted.
struct CircuitFile {
  Circuit circuit;
  Band band;  ///< in which it was judged

  /// What the stages are to do together: the sections it was made from.
  Complex wanted(RadPerSecond w) const;

  /// Errors with file and line: an unknown realisation, a part that is missing, parts that do not make what the file
  /// says they make.
  static CircuitFile from_node(const Node& node);
};

/// `resistor_percent` and `capacitor_percent`, each 0 or more and below 100; what is not there is as usual.
schematic::Tolerances tolerances_from(const Node& node);
Json to_json(const schematic::Tolerances& tolerances);

/// A transfer as circuit.json has it: `gain`, `zeros_rad_s`, `poles_rad_s`.
Section section_from_node(const Node& node);

/// stages, parts, op-amp and the error of each step; without the header.
Json to_json(const Realised& realised);
/// {"max_magnitude_db", "max_phase_deg", "max_complex_percent", "worst_hz"}.
Json to_json(const ResponseDifference& difference);
/// The same with the band in which it was found: `judged` of circuit.json.
Json judged_json(const ResponseDifference& difference, Band band);
Json to_json(const OpAmpCheck& check);

}  // namespace bodesmith::synthesis
