#include <fmt/format.h>

#include "base/error.hpp"
#include "base/json.hpp"
#include "kicad/bom.hpp"
#include "kicad/devices.hpp"

namespace bodesmith::kicad {

Sheet one_sheet(const std::vector<Group>& groups, const std::string& stem) {
  std::vector<const Group*> all;
  for (const Group& group : groups) all.push_back(&group);
  for (const Paper& paper : kPapers) {
    const Rows rows = fitted_rows(paper, all);
    if (!rows.empty()) return {stem + ".kicad_sch", paper.name, rows.drawing(), {}};
  }
  throw DesignError("the schematic is larger than an A0 sheet");
}

Sheet add_one_sheet_project(const std::vector<Group>& groups, const std::string& stem,
                            const std::string& title, const std::string& comment, OutputSet& out,
                            const std::filesystem::path& folder) {
  const Sheet sheet = one_sheet(groups, stem);
  out.add(folder / sheet.file, sheet_texts({sheet}, title, comment)[0]);
  Json project;
  project["meta"] = {{"filename", stem + ".kicad_pro"}, {"version", 1}};
  project["sheets"] = Json::array({Json::array({root_uuid(title), ""})});
  project["text_variables"] = Json::object();
  out.add(folder / (stem + ".kicad_pro"), to_text(project));
  out.add(folder / "bodesmith.kicad_sym", symbol_library_text());
  out.add(folder / "bom.csv", bill_of_materials({sheet}));
  out.add(folder / "sym-lib-table", symbol_table_text());
  return sheet;
}

}  // namespace bodesmith::kicad
