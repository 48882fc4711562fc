#pragma once

#include <vector>

#include "project/tracking/tracked_designs.hpp"
#include "project/tracking/tracking_elsewhere.hpp"
#include "tracking/track.hpp"

namespace bodesmith::project {

/// The candidates on the project's own stage: harmonic by harmonic and by CVODE, and as formulas have it.
tracking::Report follow_designs(const Project& project, const std::vector<TrackedCandidate>& candidates);

/// What was followed, put together: `elsewhere` with the built controllers in it, see tracking_elsewhere.hpp.
TrackingStudy tracking_study(const Project& project, const Design& design, const Budget& budget,
                             const std::vector<TrackedCandidate>& candidates, const tracking::Report& report,
                             const ControllersTracked& controllers, std::vector<TrackedElsewhere> elsewhere);

}  // namespace bodesmith::project
