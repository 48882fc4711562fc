#pragma once

#include <string>
#include <vector>

#include "project/budget.hpp"
#include "project/design.hpp"
#include "project/project.hpp"

namespace bodesmith::project {

/// Frequencies for tables and plots of the stages: a decade beyond `band` on either side.
std::vector<Hertz> stages_grid(const Band& band);

/// The Bode plot of all stages with the target points, as one <svg>.
std::string stages_svg(const Project& project, const Design& design, const Budget& budget);

}  // namespace bodesmith::project
