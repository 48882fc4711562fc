#pragma once

#include <string>
#include <vector>

#include "lti/frequency_grid.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// Spectral density of the noise at a node in V/sqrt(Hz), all elements' sources at once by one solution of the transposed
/// system a frequency. `flicker`: with the op-amps' 1/f corner.
std::vector<double> output_noise(const Netlist& netlist, const std::vector<Hertz>& grid, bool flicker = true,
                                 const std::string& node = "out", const std::string& input = "in");
/// Root of the integral of its square over the band, by trapezoids in log frequency (the density bends slowly).
double output_noise_rms(const Netlist& netlist, Band band, bool flicker = true,
                        const std::string& node = "out", int points = 121, const std::string& input = "in");
/// |V(out)| at rest with every op-amp's offset and bias currents at the signs that add up.
double worst_output_offset(const Netlist& netlist);

}  // namespace bodesmith::schematic
