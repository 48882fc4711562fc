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

/// Every part, op-amp, multiplier, contact and reference of a circuit of titled groups, with its type and role:
/// `part,section,series,wanted_ohm,realised_ohm,wanted_f,realised_f,type,role`.
std::string parts_csv(const Netlist& netlist);
/// Its parts, the name under the key `name`.
Json parts_json(const Netlist& netlist, const char* name);

}  // namespace bodesmith::schematic
