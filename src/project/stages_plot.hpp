#pragma once

#include <vector>

#include "project/budget.hpp"
#include "project/design.hpp"
#include "project/project.hpp"
#include "report/plot.hpp"

namespace bodesmith::project {

/// Frequencies for tables and plots of the stages: a decade beyond `band` on either side.
std::vector<Hertz> stages_grid(const Band& band);

/// The Bode plot of all stages with the target points, and beneath it how far they are apart.
std::vector<report::Plot> stages_plots(const Project& project, const Design& design, const Budget& budget);

}  // namespace bodesmith::project
