#pragma once

#include "project/design/design.hpp"

namespace bodesmith::project {

/// What a stage's gains become: a cascade by the disturbance paper's chart, its approximation, and all alternatives to that.
/// DesignError where the gains are all alike.
Design fit_stage(const Project& project);

/// What a response to build becomes: its one alternative, as asked, or what takes the fewest poles.
Design fit_response(const Project& project);

}  // namespace bodesmith::project
