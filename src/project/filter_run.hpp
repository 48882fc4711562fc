#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "project/filter_design.hpp"
#include "project/source.hpp"

namespace bodesmith::project {

/// Everything that `bodesmith run` computed and wrote of a project without a disturbance.
struct FilterRun {
  FilterProject project;
  Provenance from;
  FilterDesign design;
  std::vector<LimitCheck> limits;
  std::vector<std::filesystem::path> files;
  double compute_s = 0.0;

  bool limits_met() const;
};

/// cascade.json (where there is one), sections.json, fpaa/, spice/, yield.json, bode.csv, bode.svg, report.html, run.json.
FilterRun run_filter_project(const ProjectSource& source, const std::filesystem::path& folder);

std::string filter_summary(const FilterRun& run);
Json filter_json(const FilterRun& run);
/// Gain and phase of every stage, and beneath them what each leaves of the target.
std::string filter_svg(const FilterRun& run);
/// report.html.
std::string filter_page(const FilterRun& run);

}  // namespace bodesmith::project
