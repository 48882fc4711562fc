#pragma once

#include <complex>
#include <vector>

#include "schematic/analysis/equations.hpp"

namespace bodesmith::schematic {

/// d ln V(out)/d ln value of every resistor and capacitor at one frequency, by the adjoint network: with M x = b and
/// M' y = e_out, d V(out) = -y' dM x, whatever the number of parts. 0 for other parts, and at a null of the response.
std::vector<std::complex<double>> log_sensitivities(const Equations& equations, std::size_t parts,
                                                    RadPerSecond w);

}  // namespace bodesmith::schematic
