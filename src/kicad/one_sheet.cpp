#include <fmt/format.h>

#include "base/error.hpp"
#include "base/json.hpp"
#include "kicad/bom.hpp"
#include "kicad/devices.hpp"

namespace bodesmith::kicad {

Sheet add_one_sheet_project(const std::vector<Group>& groups, const std::string& stem,
                            const std::string& title, const std::string& comment, OutputSet& out,
                            const std::filesystem::path& folder) {
  std::vector<const Group*> all;
  for (const Group& group : groups) all.push_back(&group);
  for (const Paper& paper : kPapers) {
    const Rows rows = fitted_rows(paper, all);
    if (rows.empty()) continue;
    Sheet sheet{stem + ".kicad_sch", paper.name, rows.drawing(), {}};
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
  throw DesignError("the schematic is larger than an A0 sheet");
}

}  // namespace bodesmith::kicad
