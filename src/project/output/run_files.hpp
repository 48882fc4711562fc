#pragma once

#include <filesystem>
#include <string>

#include "base/files.hpp"
#include "project/run.hpp"

namespace bodesmith::project {

/// The files of the design itself (cascade, sections, plan, netlists, tolerances, layout, models, Bode table and plot), not yet
/// written.
OutputSet design_files(const Run& run, const std::filesystem::path& folder);

/// report.html: target, fit, the error of each stage, Bode plots, tracking, hardware.
std::string report_page(const Run& run);

}  // namespace bodesmith::project
