#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "kicad/text.hpp"

namespace bodesmith::kicad {

/// Sheets as a project: STEM.kicad_pro, the sheets (the first is the root), the symbols, and bom.csv
/// (`reference,value,footprint,netlist`), a line for everything that is mounted, in the order of the references; `netlist`
/// holds the names in the netlist of a part or of the units of a package, empty for what only the board has.
void add_project_files(const std::vector<Sheet>& sheets, const std::string& stem, const std::string& title,
                       const std::string& comment, OutputSet& out, const std::filesystem::path& folder = {});

}  // namespace bodesmith::kicad
