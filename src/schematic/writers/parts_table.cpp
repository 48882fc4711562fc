#include "schematic/writers/parts_table.hpp"

#include "base/documents/json.hpp"
#include "base/text.hpp"

namespace bodesmith::schematic {

std::vector<std::string> part_cells(const Part& part, const std::string& where) {
  std::vector<std::string> out = {part.name, where, part.series, "", "", "", ""};
  if (part.kind == Part::Kind::diode) return out;
  const std::size_t first = part.kind == Part::Kind::resistor ? 3 : 5;
  out[first] = number_text(part.wanted);
  out[first + 1] = number_text(part.realised);
  return out;
}

void add_values(Json& out, const Part& part) {
  if (part.kind == Part::Kind::diode) return;
  const bool resistor = part.kind == Part::Kind::resistor;
  out[resistor ? "wanted_ohm" : "wanted_f"] = part.wanted;
  out[resistor ? "realised_ohm" : "realised_f"] = part.realised;
}

}  // namespace bodesmith::schematic
