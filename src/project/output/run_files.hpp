#pragma once

#include <filesystem>

#include "base/files.hpp"
#include "project/run.hpp"

namespace bodesmith::project {

/// The files of the design itself (cascade, sections, plan, netlists, tolerances, layout, models, Bode table and plot), not yet
/// written.
OutputSet design_files(const Run& run, const std::filesystem::path& folder);

}  // namespace bodesmith::project
