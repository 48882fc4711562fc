#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "schematic/netlist.hpp"
#include "schematic/writers/kicad/netlist_groups.hpp"

namespace bodesmith::kicad {

/// What a sheet of a netlist says besides it.
struct SheetOptions {
  std::string stem;  ///< of the files
  std::string title;
  std::string comment;
  std::vector<std::string> ports;  ///< nodes with a connector
  bool board = true;               ///< connectors and supplies too, not the signal's way alone
};

/// Any netlist as one sheet, a section a group (netlist_groups.hpp), +-12 V for op-amps and switch, +-5 V for the multipliers.
/// The KiCad project (STEM.kicad_pro, one sheet, symbols) and the same sheet as STEM.svg.
void add_netlist_project(const schematic::Netlist& netlist, const SheetOptions& options, OutputSet& out,
                         const std::filesystem::path& folder);
/// The sheet alone, as SVG.
std::string netlist_svg(const schematic::Netlist& netlist, const SheetOptions& options);

/// A chain of stages, a group each, as a KiCad 6 project: STEM.kicad_pro, STEM.kicad_sch (and STEM_2.kicad_sch, … with whole
/// stages on sheets of their own when one A3 sheet does not hold them), the symbols in bodesmith.kicad_sym with sym-lib-table.
/// Parts are R1, R2, C1, … as boards number them; the field Netlist is their name in the netlist, which bom.csv lists next to
/// them; every node keeps its name as a label. Op-amps are units of packages U1, U2, … (`per_package` of the model); a unit that
/// is left over is a follower at ground. What a netlist does not have and a board needs is added: connectors, supplies, 100 nF
/// at every supply pin. Values in KiCad's own writing (20.5k, 10n); fields Series, Tolerance, Wanted, Realised, Section.
void add_chain_project(const schematic::Netlist& netlist, const std::vector<ChainStage>& chain,
                       const SheetOptions& options, OutputSet& out);

}  // namespace bodesmith::kicad
