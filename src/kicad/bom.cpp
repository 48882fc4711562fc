#include "kicad/bom.hpp"

#include <cstdlib>
#include <map>
#include <utility>

#include "signal/csv.hpp"

namespace bodesmith::kicad {

std::string bill_of_materials(const std::vector<Sheet>& sheets) {
  struct Line {
    std::string value, footprint;
    std::map<int, std::string> units;
  };
  std::map<std::pair<std::string, int>, Line> lines;  // letters and number
  for (const Sheet& sheet : sheets) {
    for (const Symbol& symbol : sheet.drawing.symbols) {
      if (symbol.reference.empty()) continue;  // supplies and flags
      const std::size_t digits = symbol.reference.find_first_of("0123456789");
      const int number = std::atoi(symbol.reference.c_str() + digits);
      Line& line = lines[{symbol.reference.substr(0, digits), number}];
      line.value = symbol.value;
      line.footprint = symbol.footprint;
      for (const Field& field : symbol.fields) {
        if (field.name == "Netlist") line.units[symbol.unit] = field.value;
      }
    }
  }
  CsvTable table({"reference", "value", "footprint", "netlist"});
  for (const auto& [reference, line] : lines) {
    std::string names;
    for (const auto& [unit, name] : line.units) names += (names.empty() ? "" : " ") + name;
    table.add_row({reference.first + std::to_string(reference.second), line.value, line.footprint, names});
  }
  return table.text();
}

}  // namespace bodesmith::kicad
