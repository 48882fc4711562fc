#pragma once

#include <string>
#include <vector>

#include "kicad/text.hpp"

namespace bodesmith::kicad {

/// bom.csv: `reference,value,footprint,netlist`, a line for everything that is mounted, in the order of the references;
/// `netlist` holds the names in the netlist of a part or of the units of a package, empty for what only the board has.
std::string bill_of_materials(const std::vector<Sheet>& sheets);

}  // namespace bodesmith::kicad
