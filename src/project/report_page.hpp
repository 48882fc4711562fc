#pragma once

#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "project/design.hpp"
#include "project/limits.hpp"
#include "project/project_file.hpp"
#include "project/tracking_study.hpp"

namespace bodesmith::project {

/// Everything the page shows besides the design itself.
struct ReportInput {
  const Project& project;
  const Design& design;
  const Budget& budget;
  const TrackingStudy& tracking;
  const std::vector<LimitCheck>& limits;
  std::optional<SpiceCheck> ngspice;  ///< absent: ngspice is not installed
  const Provenance& from;
};

/// report.html of a run: the wish, the fit, each stage's error, Bode plots, tracking, hardware.
std::string report_page(const ReportInput& input);

/// The Bode plot of all stages with the wanted points, as one <svg>.
std::string stages_svg(const Project& project, const Design& design, const Budget& budget);

}  // namespace bodesmith::project
