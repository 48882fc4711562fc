#include "kicad/project_files.hpp"

#include <compare>
#include <cstdlib>
#include <map>
#include <utility>

#include "base/json.hpp"
#include "base/text.hpp"
#include "signal/csv.hpp"

namespace bodesmith::kicad {
namespace {

/// What is ordered together, and in what order lines stand.
struct Order {
  std::string letters;
  std::string value, tolerance, footprint;
  auto operator<=>(const Order&) const = default;
};

/// A line for all that is alike. References and names in the netlist stand in the same order, the units of one package
/// joined by '+', '-' where the netlist has no name.
std::string bill_of_materials(const std::vector<Sheet>& sheets) {
  struct Piece {
    Order order;
    std::map<int, std::string> units;
  };
  std::map<std::pair<std::string, int>, Piece> pieces;  // letters and number
  for (const Sheet& sheet : sheets) {
    for (const Symbol& symbol : sheet.drawing.symbols) {
      if (symbol.reference.empty()) continue;  // supplies and flags
      const std::size_t digits = symbol.reference.find_first_of("0123456789");
      const std::string letters = symbol.reference.substr(0, digits);
      Piece& piece = pieces[{letters, std::atoi(symbol.reference.c_str() + digits)}];
      const std::string tolerance = piece.order.tolerance;
      piece.order = {letters, symbol.value, tolerance, symbol.footprint};
      for (const Field& field : symbol.fields) {
        if (field.name == "Netlist") piece.units[symbol.unit] = field.value;
        if (field.name == "Tolerance") piece.order.tolerance = field.value;
      }
    }
  }
  std::map<Order, std::pair<std::vector<std::string>, std::vector<std::string>>> lines;
  for (const auto& [reference, piece] : pieces) {
    auto& [references, names] = lines[piece.order];
    references.push_back(reference.first + std::to_string(reference.second));
    std::vector<std::string> units;
    for (const auto& [unit, name] : piece.units) units.push_back(name);
    names.push_back(units.empty() ? "-" : join(units, "+"));
  }
  CsvTable table({"quantity", "references", "value", "tolerance", "footprint", "netlist"});
  for (const auto& [order, line] : lines)
    table.add_row({std::to_string(line.first.size()), join(line.first, " "), order.value, order.tolerance,
                   order.footprint, join(line.second, " ")});
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
