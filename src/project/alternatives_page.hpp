#pragma once

#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {

/// The table of the alternatives; of the chosen one its response, error budget, tracking, sections and parts.
void add_alternatives(report::Page& page, const ProjectRun& run);

}  // namespace bodesmith::project
