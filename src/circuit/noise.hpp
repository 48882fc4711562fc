#pragma once

#include <vector>

#include "circuit/circuit.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::circuit {

/// Spectral density of the output noise in V/sqrt(Hz): thermal noise of every resistor (and output
/// resistance) at 300.15 K (27 C, SPICE's own temperature), voltage and current noise of every op-amp. One
/// solution of the transposed network a frequency gives the way of every source to the output. `flicker`:
/// with the op-amps' 1/f corner.
std::vector<double> output_noise(const Circuit& circuit, const OpAmpModel& model,
                                 const std::vector<Hertz>& grid, bool flicker = true);
/// Root of the integral of its square over the band.
double output_noise_rms(const Circuit& circuit, const OpAmpModel& model, Band band, bool flicker = true);
/// |V(out)| at rest with every op-amp's offset and bias currents at the signs that add up.
double worst_output_offset(const Circuit& circuit, const OpAmpModel& model);

}  // namespace bodesmith::circuit
