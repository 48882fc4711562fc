#include "project/design/filter_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "fit/choice.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "project/design/fractional_fit.hpp"
#include "schematic/analysis/equations.hpp"
#include "synthesis/circuit.hpp"
#include "tolerance/design.hpp"

namespace bodesmith::project {
namespace {

using Method = FilterProject::Fit::Method;

constexpr double kUsualFitDb = 0.05;        ///< of a direct fit when the project asks for nothing
constexpr int kLargestFittedOrder = 8;      ///< that a limit may ask for
constexpr int kDefaultFractionalOrder = 6;  ///< of a fractional transfer
constexpr std::uint64_t kYieldSamples = 20000;
constexpr int kYieldPoints = 60;

DirectFitOptions direct_options(const FilterProject& project) {
  DirectFitOptions out;
  out.deadline = project.deadline;
  out.real = project.fit.real;
  out.relative_degree = project.fit.relative_degree;
  out.max_corner = project.fit.max_corner;
  return out;
}

DirectFit fit_sections(const FilterProject& project, const BodePoints& points, DirectFitOptions options) {
  if (project.fit.order) {
    options.order = *project.fit.order;
    return fit_directly(points, options);
  }
  return fit_directly_within(points, options, project.fit.max_error_db.value_or(kUsualFitDb),
                             std::max(1, options.relative_degree), kLargestFittedOrder);
}

void take_sections(FilterDesign& design, DirectFit fit) {
  for (const std::string& one : fit.not_tried) design.not_tried.push_back("fit: " + one);
  design.sections = fit.sections;
  design.target_db = fit.max_db;
  design.direct = std::move(fit);
}

void take_cascade(const FilterProject& project, FilterDesign& design, CascadeFit fit) {
  ApproximationOptions options;
  options.method = project.approximate.method;
  options.order = project.approximate.order;
  options.max_error_db = project.approximate.max_error_db;
  design.approximation = approximate_cascade(fit.cascade, options);
  design.sections = design.approximation->sections;
  design.fit = std::move(fit);
  for (const BodePoint& point : project.points->points) {
    const double got = std::abs(design.sections.response(point.frequency.rad_s()));
    if (point.frequency > design.fit->base)
      design.target_db = std::max(design.target_db, std::abs(to_decibel(got / point.gain)));
  }
}

CascadeFitOptions cascade_options(const FilterProject& project) {
  CascadeFitOptions out;
  out.base = project.fit.base;
  if (project.fit.method == Method::bounded) out.beta_max = project.fit.beta_max;
  return out;
}

/// Points: as asked, or what takes the fewest poles within the error that was asked for; without one interpolated where that
/// can be built.
void fit_points(const FilterProject& project, FilterDesign& design) {
  const BodePoints& points = *project.points;
  const FilterProject::Fit& asked = project.fit;
  if (asked.method == Method::direct || (asked.method == Method::automatic && asked.order)) {
    take_sections(design, fit_sections(project, points, direct_options(project)));
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
      take_cascade(project, design, std::move(fit));
      return;
    }
    if (asked.method != Method::automatic)
      throw DesignError(points.file, 0, *unusable + "; expected method = \"direct\"");
    reason = *unusable;
  }
  FitChoice chosen =
      choose_fit(points, options, direct_options(project), asked.max_error_db.value_or(kUsualFitDb));
  design.how = fmt::format("{}: {}.", reason, chosen.why);
  if (chosen.cascade) {
    take_cascade(project, design, *std::move(chosen.cascade));
  } else {
    take_sections(design, *std::move(chosen.sections));
  }
}

void fit_transfer(const FilterProject& project, FilterDesign& design) {
  FractionalFitOptions options;
  options.band = project.band;
  options.order = project.fit.order;
  options.max_error_db = project.fit.max_error_db;
  options.max_order = kLargestFittedOrder;
  options.direct = direct_options(project);
  options.direct.order = kDefaultFractionalOrder;
  FractionalFit made = fit_fractional(*project.fractional, project.target_file, options);
  take_sections(design, std::move(made.fit));
  design.how = "Sections were fitted to gain and phase of the fractional transfer function.";
  if (made.stability.powers_of_s > 0.0) {
    design.how += fmt::format(" Its integrator of order {} ends at a gain of {} dB.",
                              rounded_text(made.stability.powers_of_s),
                              rounded_text(to_decibel(std::abs(design.sections.dc_gain())), 3));
  }
}

}  // namespace

void add_sections(const FilterProject& project, FilterDesign& design) {
  if (project.points) {
    fit_points(project, design);
  } else if (project.fractional) {
    fit_transfer(project, design);
  } else {
    design.sections = *project.sections;
    design.how = fmt::format("The sections are those of {}.", project.target_file);
  }
}

void add_plan(const FilterProject& project, FilterDesign& design) {
  if (!project.fpaa) return;
  fpaa::PlanOptions options;
  options.board = project.fpaa->board;
  options.clock = project.fpaa->clock;
  options.band = project.band;
  if (integrates(design.sections)) {
    design.no_plan = "the sections have a pole at 0, which a plan does not make";
    return;
  }
  auto plan = fpaa::make_plan(design.sections, options);
  if (const Refusal* refusal = refusal_of(plan)) {
    design.no_plan = refusal->reason;
  } else {
    design.plan = std::get<fpaa::Plan>(std::move(plan));
  }
}

void add_circuit(const FilterProject& project, FilterDesign& design) {
  if (project.circuit)
    design.circuit = value_or_throw(make_circuit(*project.circuit, design.sections, project.band));
}

void add_tolerances(const FilterProject& project, FilterDesign& design) {
  if (!design.circuit) return;
  if (project.deadline.passed()) {
    design.not_tried.emplace_back("tolerances");
    return;
  }
  const tolerance::Design built = tolerance::design_of_circuit(design.circuit->best.made.circuit,
                                                               stating_band(design.sections, project.band),
                                                               project.name, tolerance::OpAmps::as_built);
  tolerance::Options options;
  options.spread = project.spread;
  options.samples = kYieldSamples;
  options.grid = judging_grid(built.wanted, project.band, kYieldPoints);
  tolerance::leave_out_nulls({built}, options.grid);
  options.limit_db = project.limits.yield_db;
  design.yield = tolerance::run_monte_carlo(built, options, Team());
}

std::vector<DesignStage> filter_stages(const FilterDesign& design) {
  std::vector<DesignStage> out;
  if (design.fit) {
    out.push_back({"cascade", [&design](RadPerSecond w) { return design.fit->cascade.response(w); }});
  }
  out.push_back({"sections", [&design](RadPerSecond w) { return design.sections.response(w); }});
  if (design.plan) {
    const auto runs = std::make_shared<const fpaa::SwitchedBoard>(*design.plan);
    out.push_back({"FPAA as it runs", [runs](RadPerSecond w) { return runs->gain(w); }});
  }
  if (design.circuit) {
    const auto network = std::make_shared<const schematic::Equations>(design.circuit->best.made.circuit);
    out.push_back({"circuit with op-amps", [network](RadPerSecond w) { return network->response(w); }});
  }
  return out;
}

std::vector<LimitCheck> check_limits(const FilterProject& project, const FilterDesign& design) {
  Project::Limits got;
  if (!project.sections) got.points_db = design.target_db;
  got.fit_db = design.fit ? design.fit->cascade.fit->max_db : got.points_db;
  got.approximation_db = design.approximation ? design.approximation->error.everywhere_db : 0.0;
  if (design.plan) got.fpaa_percent = design.plan->error_with_delays.max_complex_percent;
  if (design.circuit) got.circuit_db = design.circuit->best.judged.max_magnitude_db;
  if (design.yield) got.yield_db = design.yield->worst_db.quantile(0.95);
  return check_limits(project.limits, got);
}

}  // namespace bodesmith::project
