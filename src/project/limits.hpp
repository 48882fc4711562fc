#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "project/design/design.hpp"
#include "project/project.hpp"
#include "project/tracking/tracking_study.hpp"

namespace bodesmith::project {

/// One line of [limits]: what was asked and what came out.
struct LimitCheck {
  std::string name;  ///< key in project.toml
  double limit = 0.0;
  std::optional<double> got;  ///< absent: it was not made, which is not met
  bool met() const { return got && *got <= limit; }

  std::string got_text() const;  ///< "0.0123", "not made"
};

/// Of the limits that the project sets, in the order of Limits: the sections at the points, the board as it runs, parts and op-amps
/// together, tolerances, tracking as built.
std::vector<LimitCheck> check_limits(const Project& project, const Design& design,
                                     const TrackingStudy& tracking);

/// The lines of a summary, and what run.json holds of them.
std::string limits_text(const std::vector<LimitCheck>& limits);
Json to_json(const std::vector<LimitCheck>& limits);

}  // namespace bodesmith::project
