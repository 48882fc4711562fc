#include "schematic/writers/parts_table.hpp"

#include <utility>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "signal/csv.hpp"

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

std::string parts_csv(const Netlist& netlist) {
  CsvTable table(
      {"part", "section", "series", "wanted_ohm", "realised_ohm", "wanted_f", "realised_f", "type", "role"});
  for (const Part& part : netlist.parts) {
    std::vector<std::string> row = part_cells(part, netlist.groups[part.group].title);
    std::string type = part.kind == Part::Kind::resistor ? "resistor" : "capacitor";
    if (part.kind == Part::Kind::diode) type = std::exchange(row[2], "");
    row.insert(row.end(), {type, part.role});
    table.add_row(row);
  }
  const auto component = [&](const auto& one, const std::string& type, const std::string& role) {
    table.add_row({one.name, netlist.groups[one.group].title, "", "", "", "", "", type, role});
  };
  for (const OpAmp& one : netlist.opamps) component(one, netlist.model_of(one).name, one.role);
  for (const Multiplier& one : netlist.multipliers) component(one, netlist.multiplier.name, one.role);
  for (const Contact& one : netlist.contacts)
    component(one, netlist.analog_switch.name, "closed while node " + one.control + " is at 1 V");
  for (const Source& one : netlist.sources) component(one, one.type, "node " + one.node);
  return table.text();
}

Json parts_json(const Netlist& netlist, const char* name) {
  Json out = Json::array();
  for (const Part& part : netlist.parts) {
    Json one = {{name, part.name},   {"role", part.role}, {"section", netlist.groups[part.group].title},
                {"from", part.from}, {"to", part.to},     {"series", part.series}};
    add_values(one, part);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace bodesmith::schematic
