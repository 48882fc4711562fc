#pragma once

#include <filesystem>
#include <memory>

#include "project/run.hpp"
#include "project/source.hpp"

namespace bodesmith::project {

/// Reads a project, designs and checks it, with a plant simulates how it tracks, and writes every artefact: fit, sections,
/// FPAA plan, circuit, tolerances or layout and tracking study, report. With a plant the design's files are written as
/// soon as they are known, so that an interrupted simulation does not lose them; nothing is written when the input is bad.
std::unique_ptr<Run> run_project(const ProjectSource& source, const std::filesystem::path& folder);

/// Reads the project to its end and forgets it: what is wrong in it is said before hours of work.
void check_project(const ProjectSource& source);

}  // namespace bodesmith::project
