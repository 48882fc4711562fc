#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.hpp"
#include "project/budget.hpp"
#include "project/design.hpp"
#include "project/project.hpp"

namespace bodesmith::project {

/// What compensates in a column of the tracking table.
enum class TrackedStage {
  none,        ///< no compensation at all
  polynomial,  ///< the generator's polynomial at constant gain
  cascade,
  sections,
  waveform,   ///< the best waveform fit, when something else is built
  scheduled,  ///< a gain set by the measured frequency
  fpaa,       ///< the capacitors' transfer functions alone
  fpaa_with_holds,
  circuit,
};
/// The key in run.json, and the column of tracking.csv without its unit.
std::string_view to_string(TrackedStage stage);

/// One stage of the design followed through the plant at every tracked frequency.
struct TrackedDesign {
  TrackedStage stage = TrackedStage::none;
  std::string name;                 ///< for a person
  std::vector<double> rms_percent;  ///< of the range, one a frequency (disturbance paper, eq. 8)
  std::vector<double> max_percent;
  std::vector<double> rms_percent_without_lag;  ///< the best pure delay of the reference removed
  std::vector<double> lag_s;                    ///< that delay
};

/// One period of the steady state, for the time plots.
struct TrackedPeriod {
  Hertz frequency;
  std::vector<double> time_s;
  std::vector<double> reference;                   ///< 0 to 1
  std::vector<std::vector<double>> error_percent;  ///< one curve a design
};

/// Table II of the disturbance paper (docs/papers.md) by simulation, for every stage of the design.
struct TrackingStudy {
  std::vector<Hertz> frequency;
  std::vector<TrackedDesign> designs;
  TrackedPeriod shown;  ///< at the highest tracked frequency
  /// CVODE against the exact periodic solution, rms percent of range.
  double max_cross_check_percent = 0.0;
  std::vector<std::string>
      findings;  ///< sentences: where accuracy is lost, what is worse than no compensation
  double compute_s = 0.0;

  /// Null when that stage is not part of the study.
  const TrackedDesign* find(TrackedStage stage) const;
};

TrackingStudy study_tracking(const Project& project, const Design& design, const Budget& budget);

/// The study as it stands in run.json, and as tracking.csv.
Json to_json(const TrackingStudy& study);
std::string tracking_csv(const TrackingStudy& study);

}  // namespace bodesmith::project
