#include "kicad/netlist_sheet.hpp"

#include "base/error.hpp"
#include "kicad/devices.hpp"
#include "kicad/netlist_groups.hpp"
#include "kicad/project_files.hpp"

namespace bodesmith::kicad {
namespace {

/// Every group on one sheet, the smallest paper from A4 to A0 that holds them.
Sheet one_sheet(const schematic::Netlist& netlist, const SheetOptions& options) {
  const NetlistGroups groups = netlist_groups(netlist, options.ports, options.tolerances);
  std::vector<const Group*> all;
  for (const auto* some : {&groups.sections, &groups.board})
    for (const Group& group : *some) all.push_back(&group);
  for (const Paper& paper : kPapers) {
    const Rows rows = fitted_rows(paper, all);
    if (!rows.empty()) return {options.stem + ".kicad_sch", paper.name, rows.drawing(), {}};
  }
  throw DesignError("the schematic is larger than an A0 sheet");
}

}  // namespace

void add_netlist_project(const schematic::Netlist& netlist, const SheetOptions& options, OutputSet& out,
                         const std::filesystem::path& folder) {
  const Sheet sheet = one_sheet(netlist, options);
  add_project_files({sheet}, options.stem, options.title, options.comment, out, folder);
  out.add(folder / (options.stem + ".svg"), sheet_svg(sheet, options.title));
}

std::string netlist_svg(const schematic::Netlist& netlist, const SheetOptions& options) {
  return sheet_svg(one_sheet(netlist, options), options.title);
}

}  // namespace bodesmith::kicad
