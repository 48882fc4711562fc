#pragma once

#include <string>

#include "project/run.hpp"

namespace bodesmith::project {

/// Gain and phase of every stage, and beneath them what each leaves of the target.
std::string filter_svg(const FilterRun& run);
/// report.html.
std::string filter_page(const FilterRun& run);

}  // namespace bodesmith::project
