#pragma once

#include <string>
#include <vector>

#include "schematic/netlist.hpp"
#include "schematic/writers/kicad/sheet_rows.hpp"

namespace bodesmith::kicad {

/// A group of a netlist that is a stage of a chain: the signal goes from `in` to `out`.
struct ChainStage {
  std::string in, out;
  std::string text;  ///< above it
};

/// A netlist as cells: a group each of its own, and what a board needs besides: connectors (`ports`: nodes with one), supplies,
/// references, 100 nF at every op-amp package, units that are left over. Parts are R1, C1, D1, U1, …, op-amps and contacts
/// units of packages; their netlist name is the field Netlist. `chain`: one for each group, or none.
struct NetlistGroups {
  std::vector<Group> sections, board;
};
NetlistGroups netlist_groups(const schematic::Netlist& netlist, const std::vector<std::string>& ports,
                             const std::vector<ChainStage>& chain = {});

/// 20500 is "20.5k", 1e-8 is "10n"; up to 6 digits.
std::string kicad_value(double value);

}  // namespace bodesmith::kicad
