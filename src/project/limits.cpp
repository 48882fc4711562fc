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

std::vector<LimitCheck> check_limits(const Project& project, const Design& design,
                                     const TrackingStudy& tracking) {
  using Limits = Project::Limits;
  std::vector<LimitCheck> out;
  const auto check = [&](const char* name, std::optional<double> Limits::*limit, std::optional<double> got) {
    if (project.limits.*limit) out.push_back({name, *(project.limits.*limit), got});
  };
  std::optional<double> points, fpaa, circuit, tracked, yield;
  if (!project.target.sections) points = design.built().points_max_db;
  if (design.plan) fpaa = design.plan->error_with_delays.max_complex_percent;
  if (design.circuit) circuit = design.circuit->best.judged.max_magnitude_db;
  if (const TrackedDesign* built = tracking.find(tracking.as_built))
    tracked = built->worst_without_lag_percent();
  if (design.yield) yield = design.yield->worst_db.quantile(0.95);
  check("fit_db", &Limits::fit_db, design.fit ? design.fit->cascade.fit->max_db : points);
  check("points_db", &Limits::points_db, points);
  check("approximation_db", &Limits::approximation_db,
        design.approximation ? design.approximation->error.everywhere_db : 0.0);
  check("fpaa_percent", &Limits::fpaa_percent, fpaa);
  check("circuit_db", &Limits::circuit_db, circuit);
  check("tracking_percent", &Limits::tracking_percent, tracked);
  check("agreement_percent", &Limits::agreement_percent, worst_agreement(tracking.engines));
  check("yield_db", &Limits::yield_db, yield);
  return out;
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
