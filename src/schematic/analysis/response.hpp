#pragma once

#include <complex>
#include <vector>

#include "schematic/analysis/equations.hpp"

namespace bodesmith::schematic {

/// V(out)/V(in) of the whole network over a grid, so that every stage loads the one before it.
std::vector<std::complex<double>> network_response(const Netlist& netlist, const std::vector<Hertz>& grid,
                                                   const Assumptions& assumptions = {});

/// Return ratio of an op-amp with all others at work, -A (v+ - v-) for its own source set to 1 V and the input at rest:
/// 1 + T is what must not vanish. Every feedback is in it.
std::complex<double> return_ratio(const Equations& equations, const Netlist& netlist, std::size_t opamp,
                                  RadPerSecond w);

}  // namespace bodesmith::schematic
