#pragma once

#include <filesystem>

#include "base/files.hpp"
#include "project/run.hpp"

namespace bodesmith::project {

/// The files of the design itself (cascade, sections, plan, netlists, layout, Bode table and plot), not yet written.
OutputSet design_files(const ProjectRun& run, const std::filesystem::path& folder);

/// Plan, picture and build sheets under fpaa/; `plan_json` is the plan as its file holds it.
void add_board_files(const fpaa::Plan& plan, std::string plan_json, OutputSet& out);

/// cascade.json (where there is one), sections.json, fpaa/, spice/, yield.json, bode.csv, bode.svg, report.html.
OutputSet filter_files(const FilterRun& run, const std::filesystem::path& folder);

}  // namespace bodesmith::project
