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
#include "project/design/filter_design.hpp"
#include "project/limits.hpp"
#include "project/project.hpp"
#include "project/tracking/tracking_study.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "tolerance/controller/report.hpp"

namespace bodesmith::project {

/// Everything that `bodesmith run` computed and wrote, of any project.
struct Run {
  virtual ~Run() = default;

  Provenance from;
  std::vector<LimitCheck> limits;
  std::vector<std::string> not_tried;        ///< in the time given
  std::vector<std::filesystem::path> files;  ///< written, relative to the output folder
  double compute_s = 0.0;

  /// Everything asked for is made, keeps [limits], and can be built.
  bool limits_met() const;
  /// Why something that was made, or was not, is not to be built as it stands.
  virtual std::vector<std::string> shortfalls() const = 0;
  /// run.json without its header.
  virtual Json json() const = 0;
  /// The summary that `bodesmith run` prints: what was built, how good it is, the limits, where to look.
  virtual std::string summary(const std::filesystem::path& folder) const = 0;
  /// What a table of variants compares, each with its unit in the name; what a project does not make is left out.
  virtual std::vector<std::pair<std::string, double>> figures() const = 0;
};

/// Of a project with a plant: alternatives, the one that is built, and how a stage tracks with it.
struct ProjectRun final : Run {
  Project project;
  Design design;
  Budget budget;
  TrackingStudy tracking;
  std::vector<AlternativeStudy> alternatives;  ///< one for each of design.alternatives
  std::optional<synthesis::CompensatorCheck>
      ngspice;  ///< absent when ngspice is not installed, or the project has no circuit
  std::optional<tolerance::ControllerReport> part_errors;  ///< of the analog controller

  std::vector<std::string> shortfalls() const override;
  Json json() const override;
  std::string summary(const std::filesystem::path& folder) const override;
  /// summary.txt: the summary with all alternatives, every tracked frequency, and the notes.
  std::string tables() const;
  /// poles, points_db, fpaa_percent, circuit_db, tracking_percent (as built, worst of all frequencies, without lag).
  std::vector<std::pair<std::string, double>> figures() const override;
};

/// Of a project without one: a response to build.
struct FilterRun final : Run {
  FilterProject project;
  FilterDesign design;

  std::vector<std::string> shortfalls() const override;
  Json json() const override;
  std::string summary(const std::filesystem::path& folder) const override;
  /// poles, target_db, fpaa_percent, circuit_db, yield_db (95 of 100 circuits).
  std::vector<std::pair<std::string, double>> figures() const override;
};

}  // namespace bodesmith::project
