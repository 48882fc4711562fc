#pragma once

#include <string>
#include <vector>

#include "project/tracked_designs.hpp"

namespace bodesmith::project {

/// Sentences for a person: where a stage is worse than no compensation, where most accuracy is lost, and where a figure
/// says less than it seems to.
std::vector<std::string> tracking_findings(const Project& project, const Design& design, const Budget& budget,
                                           const std::vector<TrackedCandidate>& candidates,
                                           const tracking::Report& report, const TrackingStudy& study);

}  // namespace bodesmith::project
