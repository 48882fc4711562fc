#pragma once

#include <complex>
#include <functional>
#include <span>

#include "base/document.hpp"
#include "lti/frequency_grid.hpp"
#include "synthesis/circuit.hpp"

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

/// H(jw) of a stage with ideal op-amps for any values of its parts.
using PartsResponse = std::function<std::complex<double>(std::span<const double>, RadPerSecond)>;

/// Of a ladder's stage, -Z/R with the ladder in the feedback, -R/Z with it at the input, R the first of the values; null
/// for a stage that has a form.
PartsResponse ladder_response(const Stage& stage);

}  // namespace bodesmith::circuit
