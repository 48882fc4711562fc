#include "kicad/project_files.hpp"

#include <cstdlib>
#include <map>
#include <utility>

#include "base/json.hpp"
#include "signal/csv.hpp"

namespace bodesmith::kicad {
namespace {

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

}  // namespace

void add_project_files(const std::vector<Sheet>& sheets, const std::string& stem, const std::string& title,
                       const std::string& comment, OutputSet& out, const std::filesystem::path& folder) {
  const std::vector<std::string> texts = sheet_texts(sheets, title, comment);
  for (std::size_t i = 0; i < sheets.size(); ++i) out.add(folder / sheets[i].file, texts[i]);
  Json project;
  project["meta"] = {{"filename", stem + ".kicad_pro"}, {"version", 1}};
  project["sheets"] = Json::array({Json::array({root_uuid(title), ""})});
  project["text_variables"] = Json::object();
  out.add(folder / (stem + ".kicad_pro"), to_text(project));
  out.add(folder / "bodesmith.kicad_sym", symbol_library_text());
  out.add(folder / "bom.csv", bill_of_materials(sheets));
  out.add(folder / "sym-lib-table", symbol_table_text());
}

}  // namespace bodesmith::kicad
