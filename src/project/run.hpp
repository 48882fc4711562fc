#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "part_errors/report.hpp"
#include "project/alternative_study.hpp"
#include "project/budget.hpp"
#include "project/design.hpp"
#include "project/limits.hpp"
#include "project/project.hpp"
#include "project/source.hpp"
#include "project/tracking_study.hpp"
#include "spice/compensator_check.hpp"

namespace bodesmith::project {

/// Everything that `bodesmith run` computed and wrote.
struct ProjectRun {
  Project project;
  Provenance from;
  Design design;
  Budget budget;
  TrackingStudy tracking;
  std::vector<AlternativeStudy> alternatives;  ///< one for each of design.alternatives
  std::optional<spice::CompensatorCheck>
      ngspice;  ///< absent when ngspice is not installed, or the project has no circuit
  std::optional<part_errors::Report> part_errors;  ///< of the analog controller
  std::vector<LimitCheck> limits;
  double compute_s = 0.0;
  std::vector<std::string> not_tried;        ///< in the time given
  std::vector<std::filesystem::path> files;  ///< written, relative to the output folder

  bool limits_met() const;
};

/// Reads a project, designs, checks and simulates it, and writes every artefact: fit, sections, FPAA plan, circuit,
/// layout, tracking study, report. The design's files are written as soon as they are known, so that an
/// interrupted simulation does not lose them; nothing is written when the input is bad.
ProjectRun run_project(const ProjectSource& source, const std::filesystem::path& folder);

}  // namespace bodesmith::project
