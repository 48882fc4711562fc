#pragma once

#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// First seven cells of a row of parts.csv (contract): name, `where`, series, `wanted_ohm,realised_ohm,wanted_f,realised_f`.
/// A cell that does not apply is empty; of a diode, whose series is its type, all four are.
std::vector<std::string> part_cells(const Part& part, const std::string& where);

/// The same four as keys of a JSON object.
void add_values(Json& out, const Part& part);

}  // namespace bodesmith::schematic
