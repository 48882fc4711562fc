#pragma once

#include <complex>
#include <vector>

#include "circuit/circuit.hpp"

namespace bodesmith::circuit {

/// V(out)/V(in) of the whole network, solved at once by modified nodal analysis with the realised parts, so
/// that every stage loads the one before it. `model` is used for every op-amp.
std::vector<std::complex<double>> network_response(const Circuit& circuit, const std::vector<Hertz>& grid,
                                                   const OpAmpModel& model);
/// The same with ideal op-amps (nullors): an independent check of Circuit::response().
std::vector<std::complex<double>> network_response_ideal(const Circuit& circuit,
                                                         const std::vector<Hertz>& grid);

/// Circuit::response() over a grid.
std::vector<std::complex<double>> circuit_response(const Circuit& circuit, const std::vector<Hertz>& grid);
inline std::complex<double> circuit_response(const Circuit& circuit, RadPerSecond w) {
  return circuit.response(w);
}

}  // namespace bodesmith::circuit
