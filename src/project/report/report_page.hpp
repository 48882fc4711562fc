#pragma once

#include <string>

#include "project/run.hpp"

namespace bodesmith::project {

/// report.html of a run: target, fit, the error of each stage, Bode plots, tracking, hardware.
std::string report_page(const Run& run);

}  // namespace bodesmith::project
