#include "project/design/target_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "fit/choice.hpp"
#include "project/design/fractional_fit.hpp"

namespace bodesmith::project {
namespace {

using Method = Project::Fit::Method;

constexpr double kUsualFitDb = 0.05;        ///< of a direct fit when the project asks for nothing
constexpr int kLargestFittedOrder = 8;      ///< that a limit may ask for
constexpr int kDefaultFractionalOrder = 6;  ///< of a fractional transfer

CascadeFitOptions cascade_options(const Project& project) {
  CascadeFitOptions out;
  out.base = project.target.base;
  if (project.fit.method == Method::bounded) out.beta_max = project.fit.beta_max;
  out.beta_positive = project.fit.beta_positive;
  return out;
}

DirectFitOptions direct_options(const Project& project) {
  DirectFitOptions out = project.fit.direct;
  out.deadline = project.deadline;
  return out;
}

void approximate_fit(const Project& project, CascadeFit fit, Design& design) {
  design.approximation = approximate_cascade(fit.cascade, project.approximate);
  design.fit = std::move(fit);
}

void take_cascade(const Project& project, CascadeFit fit, Design& design) {
  approximate_fit(project, std::move(fit), design);
  Alternative& made = design.alternatives.emplace_back();
  made.sections = design.approximation->sections;
  made.points_max_db =
      max_error_at_points(project, [&](RadPerSecond w) { return made.sections.response(w); });
}

void take_sections(DirectFit fit, Design& design) {
  for (const std::string& one : fit.not_tried) design.not_tried.push_back("fit: " + one);
  Alternative& made = design.alternatives.emplace_back();
  made.kind = Alternative::Kind::direct;
  made.sections = fit.sections;
  made.points_max_db = fit.max_db;
  design.direct = std::move(fit);
}

/// As asked, or what takes the fewest poles within the error that was asked for; without one interpolated where that can be
/// built.
void fit_points(const Project& project, Design& design) {
  const BodePoints& points = project.target.points;
  const Project::Fit& asked = project.fit;
  DirectFitOptions direct = direct_options(project);
  if (asked.method == Method::direct || (asked.method == Method::automatic && asked.order)) {
    direct.order = asked.order.value_or(direct.order);
    take_sections(asked.order ? fit_directly(points, direct)
                              : fit_directly_within(points, direct, asked.max_error_db.value_or(kUsualFitDb),
                                                    std::max(1, direct.relative_degree), kLargestFittedOrder),
                  design);
    design.how = "Sections were fitted to the points directly, as asked.";
    return;
  }
  const CascadeFitOptions options = cascade_options(project);
  const bool fewest = asked.method == Method::automatic && asked.max_error_db;
  std::string reason =
      fewest ? fmt::format("The fewest poles within {} dB", rounded_text(*asked.max_error_db))
             : fmt::format("{} points would make {} bands", points.points.size(), points.points.size() - 1);
  if (!fewest && (points.points.size() <= kMostPointsToInterpolate || asked.method != Method::automatic)) {
    CascadeFit fit = fit_cascade(points, options);
    const auto unusable = why_unusable(fit);
    if (!unusable) {
      design.how = fmt::format("A cascade of {} fractional terms goes through the points.", fit.terms.size());
      take_cascade(project, std::move(fit), design);
      return;
    }
    if (asked.method != Method::automatic)
      throw DesignError(points.file, 0, *unusable + "; expected method = \"direct\"");
    reason = *unusable;
  }
  FitChoice chosen = choose_fit(points, options, direct, asked.max_error_db.value_or(kUsualFitDb));
  design.how = fmt::format("{}: {}.", reason, chosen.why);
  if (chosen.cascade) {
    take_cascade(project, *std::move(chosen.cascade), design);
  } else {
    take_sections(*std::move(chosen.sections), design);
  }
}

void fit_transfer(const Project& project, Design& design) {
  FractionalFitOptions options;
  options.band = project.target.band;
  options.order = project.fit.order;
  options.max_error_db = project.fit.max_error_db;
  options.max_order = kLargestFittedOrder;
  options.direct = direct_options(project);
  options.direct.order = kDefaultFractionalOrder;
  FractionalFit made = fit_fractional(*project.target.fractional, project.target.file, options);
  take_sections(std::move(made.fit), design);
  design.how = "Sections were fitted to gain and phase of the fractional transfer function.";
  if (made.stability.powers_of_s > 0.0) {
    design.how += fmt::format(" Its integrator of order {} ends at a gain of {} dB.",
                              rounded_text(made.stability.powers_of_s),
                              rounded_text(to_decibel(std::abs(design.sections().dc_gain())), 3));
  }
}

}  // namespace

Design fit_stage(const Project& project) {
  const Stopwatch watch;
  Design design;
  ChartedFit charted = fit_by_chart(project.target.points, cascade_options(project));
  charted.fit.warnings.insert(charted.fit.warnings.end(), charted.steps.begin(), charted.steps.end());
  approximate_fit(project, std::move(charted.fit), design);
  const Sections& sections = design.approximation->sections;
  if (sections.sections.empty()) {
    throw DesignError("the target's gains are all alike: no filter is needed, its gain is " +
                      rounded_text(sections.gain, 6) +
                      "; the controller without one is made by bodesmith controller DISTURBANCE.json");
  }
  design.compute_s = watch.seconds();
  const Stopwatch alternatives_watch;
  design.alternatives = make_alternatives(project, *design.approximation);
  design.alternatives_s = alternatives_watch.seconds();
  return design;
}

Design fit_response(const Project& project) {
  const Stopwatch watch;
  Design design;
  if (project.target.has_points()) {
    fit_points(project, design);
  } else if (project.target.fractional) {
    fit_transfer(project, design);
  } else {
    design.alternatives.emplace_back().sections = *project.target.sections;
    design.how = fmt::format("The sections are those of {}.", project.target.file);
  }
  design.compute_s = watch.seconds();
  return design;
}

}  // namespace bodesmith::project
