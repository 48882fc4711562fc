#pragma once

#include <string>
#include <utility>
#include <vector>

#include "project/filter_run.hpp"
#include "project/run.hpp"

namespace bodesmith::project {

/// What a table of variants compares, each with its unit in the name; what a project does not make is left out.
using SweepFigures = std::vector<std::pair<std::string, double>>;

/// poles, points_db, fpaa_percent, circuit_db, tracking_percent (as built, worst of all frequencies, without lag).
SweepFigures sweep_figures(const ProjectRun& run);
/// poles, target_db, fpaa_percent, circuit_db, yield_db (95 of 100 circuits).
SweepFigures sweep_figures(const FilterRun& run);

}  // namespace bodesmith::project
