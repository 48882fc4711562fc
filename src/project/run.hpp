#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/provenance.hpp"
#include "project/design/budget.hpp"
#include "project/design/design.hpp"
#include "project/limits.hpp"
#include "project/project.hpp"
#include "project/tracking/tracking_study.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "tolerance/controller/report.hpp"

namespace bodesmith::project {

/// Everything that `bodesmith run` computed and wrote, of any project: without a plant the target's own design, with one the
/// alternatives, the one that is built, and how the stage tracks with it.
struct Run {
  Provenance from;
  Project project;
  Design design;
  std::vector<LimitCheck> limits;
  std::vector<std::string> not_tried;        ///< in the time given
  std::vector<std::filesystem::path> files;  ///< written, relative to the output folder
  double compute_s = 0.0;

  // Of a plant.
  Budget budget;
  TrackingStudy tracking;
  std::vector<AlternativeStudy> alternatives;  ///< one for each of design.alternatives
  std::optional<synthesis::CompensatorCheck>
      ngspice;  ///< absent when ngspice is not installed, or the project has no circuit
  std::optional<tolerance::ControllerReport> part_errors;  ///< of the analog controller

  /// Everything asked for is made, keeps [limits], and can be built.
  bool limits_met() const;
  /// Why something that was made, or was not, is not to be built as it stands.
  std::vector<std::string> shortfalls() const;
  /// run.json without its header.
  Json json() const;
  /// The summary that `bodesmith run` prints: what was built, how good it is, the limits, where to look.
  std::string summary(const std::filesystem::path& folder) const;
  /// summary.txt of a plant: the summary with all alternatives, every tracked frequency, and the notes.
  std::string tables() const;
  /// What a table of variants compares, each with its unit in the name; what a project does not make is left out: poles,
  /// points_db of a plant (else target_db), fpaa_percent, circuit_db, tracking_percent (as built, worst of all frequencies,
  /// without lag), yield_db (95 of 100 circuits).
  std::vector<std::pair<std::string, double>> figures() const;
};

/// Reads a project, designs and checks it, with a plant simulates how it tracks, and writes every artefact: fit, sections,
/// FPAA plan, circuit, tolerances or layout and tracking study, report. The design's files are written as soon as they are known,
/// so that an interrupted simulation does not lose them; nothing is written when the input is bad.
Run run_project(const ProjectSource& source, const std::filesystem::path& folder);

}  // namespace bodesmith::project
