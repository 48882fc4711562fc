#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "circuit/parts/tolerances.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::kicad {

/// What a sheet of a netlist says beside it.
struct SheetOptions {
  std::string stem;  ///< of the files
  std::string title;
  std::string comment;
  std::vector<std::string> ports;  ///< nodes with a connector
  circuit::Tolerances tolerances;
};

/// Any netlist as one sheet, a section a group (netlist_groups.hpp), +-12 V for op-amps and switch, +-5 V for the multipliers.
/// The KiCad project (STEM.kicad_pro, one sheet, symbols) and the same sheet as STEM.svg.
void add_netlist_project(const schematic::Netlist& netlist, const SheetOptions& options, OutputSet& out,
                         const std::filesystem::path& folder);
/// The sheet alone, as SVG.
std::string netlist_svg(const schematic::Netlist& netlist, const SheetOptions& options);

}  // namespace bodesmith::kicad
