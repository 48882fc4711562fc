#pragma once

#include <string>

#include "lti/frequency_grid.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// Resistors, capacitors and op-amps as a sheet of LTspice (.asc): its own symbols res, cap, voltage and opamps/opamp, whose pins
/// lie where LTspice's library has them; each pin leads by a short wire to the name of its net, so that nets, and no long wires,
/// connect the parts. An analysis from a tenth to ten times the band; `source` is named next to it.
std::string ltspice_sheet(const Netlist& netlist, Band band, const std::string& source);

}  // namespace bodesmith::schematic
