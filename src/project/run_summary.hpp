#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "project/run.hpp"

namespace bodesmith::project {

/// run.json without its header.
Json run_json(const ProjectRun& run);

/// The summary that `bodesmith run` prints.
std::string run_summary(const ProjectRun& run);

}  // namespace bodesmith::project
