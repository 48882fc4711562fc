#pragma once

#include <filesystem>
#include <string>

#include "base/files.hpp"
#include "circuit/parts/tolerances.hpp"
#include "controller/controller.hpp"

namespace bodesmith::controller {

/// The KiCad project (controller.kicad_pro, one sheet, symbols) and the same sheet as controller.svg. Parts are R1, C1,
/// D1, U1, …, op-amps and contacts units of packages; their netlist name is the field Netlist
/// and stands in bom.csv. Added for the board: connectors, +-12 V for op-amps and switch, +-5 V for the
/// multipliers, 100 nF at every op-amp package.
void add_schematic(const AnalogController& controller, const std::string& title, OutputSet& out,
                   const std::filesystem::path& folder, const circuit::Tolerances& tolerances = {});

}  // namespace bodesmith::controller
