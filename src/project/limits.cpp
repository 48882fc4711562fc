#include "project/limits.hpp"

namespace bodesmith::project {

std::vector<LimitCheck> check_limits(const Project& project, const Design& design) {
  std::vector<LimitCheck> checks;
  const auto& limits = project.limits;
  if (limits.fit_db && design.fit.cascade.fit)
    checks.push_back({"fit_db", *limits.fit_db, design.fit.cascade.fit->max_db});
  if (limits.points_db) {
    checks.push_back({"points_db", *limits.points_db, design.alternatives[design.chosen].points_max_db});
  }
  if (limits.approximation_db) {
    checks.push_back(
        {"approximation_db", *limits.approximation_db, design.approximation.error.everywhere_db});
  }
  if (limits.fpaa_percent && design.plan) {
    checks.push_back(
        {"fpaa_percent", *limits.fpaa_percent, design.plan->error_with_delays.max_complex_percent});
  }
  if (limits.circuit_db && design.circuit) {
    checks.push_back({"circuit_db", *limits.circuit_db, design.circuit->report.parts.max_magnitude_db});
  }
  return checks;
}

}  // namespace bodesmith::project
