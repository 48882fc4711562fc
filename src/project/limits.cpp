#include "project/limits.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/text.hpp"

namespace bodesmith::project {
namespace {

/// Nothing where an engine that could say something is not there.
std::optional<double> worst_agreement(const std::vector<EngineRow>& rows) {
  std::optional<double> out;
  for (const EngineRow& one : rows) {
    const bool board = !one.cvode_percent;
    if (board && !one.ngspice_percent) continue;
    if (!one.ngspice_percent || !one.agreement_percent) return std::nullopt;
    out = std::max(out.value_or(0.0), *one.agreement_percent);
  }
  return out;
}

}  // namespace

std::string LimitCheck::got_text() const {
  return got ? rounded_text(*got, 3) : "not made";
}

std::vector<LimitCheck> check_limits(const Project::Limits& limits, const Project::Limits& got) {
  std::vector<LimitCheck> out;
  const auto check = [&](const char* name, std::optional<double> Project::Limits::*which) {
    if (limits.*which) out.push_back({name, *(limits.*which), got.*which});
  };
  check("fit_db", &Project::Limits::fit_db);
  check("points_db", &Project::Limits::points_db);
  check("approximation_db", &Project::Limits::approximation_db);
  check("fpaa_percent", &Project::Limits::fpaa_percent);
  check("circuit_db", &Project::Limits::circuit_db);
  check("tracking_percent", &Project::Limits::tracking_percent);
  check("agreement_percent", &Project::Limits::agreement_percent);
  check("yield_db", &Project::Limits::yield_db);
  return out;
}

std::vector<LimitCheck> check_limits(const Project& project, const Design& design,
                                     const TrackingStudy& tracking) {
  Project::Limits got;
  if (design.fit.cascade.fit) got.fit_db = design.fit.cascade.fit->max_db;
  got.points_db = design.built().points_max_db;
  got.approximation_db = design.approximation.error.everywhere_db;
  if (design.plan) got.fpaa_percent = design.plan->error_with_delays.max_complex_percent;
  if (design.circuit) got.circuit_db = design.circuit->best.judged.max_magnitude_db;
  if (const TrackedDesign* built = tracking.find(tracking.as_built))
    got.tracking_percent = built->worst_without_lag_percent();
  got.agreement_percent = worst_agreement(tracking.engines);
  return check_limits(project.limits, got);
}

std::string limits_text(const std::vector<LimitCheck>& limits) {
  std::string out;
  for (const LimitCheck& check : limits)
    out += fmt::format("limit      {} {}: {} {}\n", check.name, rounded_text(check.limit), check.got_text(),
                       check.met() ? "met" : "NOT met");
  return out;
}

Json to_json(const std::vector<LimitCheck>& limits) {
  Json out = Json::array();
  for (const LimitCheck& check : limits)
    out.push_back({{"name", check.name},
                   {"limit", check.limit},
                   {"got", check.got ? Json(*check.got) : Json(nullptr)},
                   {"met", check.met()}});
  return out;
}

}  // namespace bodesmith::project
