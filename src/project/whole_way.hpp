#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "base/json_fwd.hpp"
#include "base/provenance.hpp"
#include "project/design.hpp"
#include "project/limits.hpp"
#include "project/project_file.hpp"
#include "project/tracking_study.hpp"
#include "spice/check.hpp"

namespace bodesmith::project {

/// Everything that `bodesmith run` found out and wrote.
struct WholeWay {
  Project project;
  Provenance from;
  Design design;
  Budget budget;
  TrackingStudy tracking;
  std::optional<SpiceCheck> ngspice;  ///< absent when ngspice is not installed, or no circuit was wanted
  std::vector<LimitCheck> limits;
  double compute_s = 0.0;
  std::vector<std::filesystem::path> files;  ///< written, relative to the output folder

  bool limits_met() const;
  /// run.json without the header.
  Json summary_json() const;
  std::string summary_text() const;
};

/// Reads a project and goes the whole way: fit, sections, FPAA plan, circuit, layout, simulation, report. The
/// design's artefacts are written as soon as they stand, so that an interrupted simulation does not lose
/// them; nothing is written when the input is bad.
WholeWay go_the_whole_way(const std::filesystem::path& project_file, const std::filesystem::path& folder);

}  // namespace bodesmith::project
