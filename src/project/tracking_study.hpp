#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "project/design.hpp"
#include "project/project_file.hpp"

namespace bodesmith::project {

/// One design choice followed through the stage at every tracked frequency.
struct TrackedDesign {
  std::string key;                  ///< column name without its unit: "none", "polynomial", "cascade", ...
  std::string name;                 ///< for a person
  std::vector<double> rms_percent;  ///< of the range (first seed, eq. 8), one a frequency
  std::vector<double> max_percent;
  std::vector<double> rms_percent_without_lag;  ///< the best pure delay of the reference taken out
  std::vector<double> lag_s;                    ///< that delay
};

/// One period of the steady state, for the time plots.
struct TrackedPeriod {
  Hertz frequency;
  std::vector<double> time_s;
  std::vector<double> reference;                   ///< 0 to 1
  std::vector<std::vector<double>> error_percent;  ///< one curve a design
};

/// The first seed's Table II by simulation, for every stage of the design.
struct TrackingStudy {
  std::vector<Hertz> frequency;
  std::vector<TrackedDesign> designs;
  TrackedPeriod shown;  ///< at the highest tracked frequency
  double largest_cross_check_percent =
      0.0;                            ///< CVODE against the exact periodic solution, rms percent of range
  std::vector<std::string> findings;  ///< sentences: where accuracy is lost, what is worse than none
  double compute_s = 0.0;

  const TrackedDesign* find(const std::string& key) const;
  Json to_json() const;
  std::string csv() const;
};

TrackingStudy study_tracking(const Project& project, const Design& design, const Budget& budget);

}  // namespace bodesmith::project
