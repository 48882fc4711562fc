#pragma once

#include <filesystem>

#include "base/document.hpp"
#include "base/provenance.hpp"
#include "circuit/circuit.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::circuit {

/// A circuit.json (`bodesmith.circuit/1`) read back: the circuit that was made, its parts as they are mounted.
struct CircuitFile {
  Circuit circuit;
  Band band;  ///< in which it was judged

  /// What the stages are to do together: the sections it was made from.
  std::complex<double> wanted(RadPerSecond w) const;

  /// Errors with file and line: an unknown realisation, a part that is missing, parts that do not make what the file
  /// says they make.
  static CircuitFile from_node(const Node& node);
};

}  // namespace bodesmith::circuit
