#pragma once

#include <array>
#include <string>

#include "schematic/writers/kicad/cell.hpp"
#include "schematic/writers/kicad/text.hpp"

/// Cells besides op-amps and their parts: multiplier, contacts of a switch, diode, voltage reference, connectors,
/// supplies. Pin numbers of the AD835, ADG413 and ADR45xx are
/// remembered, to be compared with the data sheets before a board is made.
namespace bodesmith::kicad {

/// X, Y, Z and W; the other ends of the inputs at ground, +-5 V.
Cell multiplier_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                     const std::string& x, const std::string& y, const std::string& z, const std::string& w);
/// One contact of an ADG413: `unit` 0 to 3; 0 and 3 are closed at logic 1, the others at 0.
Cell contact_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                  int unit, const std::string& from, const std::string& to, const std::string& control);
/// Its supplies.
Cell contact_supply_cell(const std::string& reference, const std::string& value);
Cell diode_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                const std::string& anode, const std::string& cathode);
Cell reference_cell(const std::string& reference, const std::string& value, const std::string& netlist,
                    const std::string& out);
/// Two pins: `net` and ground.
Cell connector_cell(const std::string& reference, const std::string& net);
/// VCC, ground, VEE; or V5P and V5N.
Cell supply_connector_cell(const std::string& reference, const std::string& positive,
                           const std::string& negative);
/// The power unit of an op-amp package between VCC and VEE with 100 nF at each pin.
Cell package_supply_cell(Symbol unit, const std::array<std::string, 2>& capacitors);
/// An op-amp that nothing uses: a follower at ground.
Cell spare_opamp_cell(Symbol unit);

/// A unit (from 0) of an op-amp package; unit `per_package` is the power unit.
Symbol opamp_symbol(const std::string& reference, const std::string& type, int per_package, int unit);

/// The sheet as SVG: symbols, wires, names and values as KiCad shows them.
std::string sheet_svg(const Sheet& sheet, const std::string& title);

}  // namespace bodesmith::kicad
