#include "project/design.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "circuit/response.hpp"

namespace bodesmith::project {
namespace {

using Complex = std::complex<double>;

CascadeFitOptions fit_options(const Project& project) {
  CascadeFitOptions options;
  options.base = project.target.base;
  if (project.fit.bounded) options.beta_max = project.fit.beta_max;
  options.beta_positive = project.fit.beta_positive;
  return options;
}

ApproximationOptions approximation_options(const Project& project) {
  ApproximationOptions options;
  options.method = project.approximate.method;
  options.order = project.approximate.order;
  options.max_error_db = project.approximate.max_error_db;
  return options;
}

/// Where the stages are compared: the wanted points and every corner of cascade and sections.
Band design_band(const Project& project, const Design& design) {
  Band band{project.target.points.points.front().frequency, project.target.points.points.back().frequency};
  const auto widen = [&band](const Band& other) {
    if (!(other.from.value > 0.0) || !(other.to >= other.from)) return;
    band.from = std::min(band.from, other.from);
    band.to = std::max(band.to, other.to);
  };
  if (!design.fit.cascade.terms.empty()) widen(design.fit.cascade.corner_band());
  widen(design.sections().corner_band());
  return band;
}

/// Plan and circuit of the chosen sections. Throws DesignError when the board or the parts cannot make them.
void build_hardware(const Project& project, Design& design) {
  design.plan.reset();
  design.circuit.reset();
  if (project.fpaa) {
    fpaa::PlanOptions options;
    options.board = project.fpaa->board;
    options.clock = project.fpaa->clock;
    options.band = design_band(project, design);
    design.plan = fpaa::make_plan(design.sections(), options);
  }
  if (project.circuit) {
    RealiseOptions options;
    options.realization = project.circuit->realization;
    options.resistors = Series::named(project.circuit->resistors);
    options.capacitors = Series::named(project.circuit->capacitors);
    design.circuit = realise(design.sections(), options);
  }
}

}  // namespace

Design make_design(const Project& project) {
  const Stopwatch watch;
  Design design;
  design.fit = fit_cascade(project.target.points, fit_options(project));
  design.approximation = approximate_cascade(design.fit.cascade, approximation_options(project));
  const Stopwatch beside;
  design.alternatives = make_alternatives(project, design.approximation);
  design.alternatives_s = beside.seconds();
  const std::vector<std::size_t> ranked = rank_alternatives(project, design.alternatives);
  for (const std::size_t candidate : ranked) {
    design.chosen = candidate;
    try {
      build_hardware(project, design);
      break;
    } catch (const DesignError& error) {
      if (candidate == ranked.back()) throw;
      design.passed_over.push_back(design.alternatives[candidate].name + ": " + error.what());
    }
  }
  design.layout = layout_disturbance(project.target.disturbance);
  design.compute_s = watch.seconds() - design.alternatives_s;
  return design;
}

std::vector<DesignStage> design_stages(const Design& design) {
  std::vector<DesignStage> stages;
  stages.push_back({"cascade", "", [&design](RadPerSecond w) { return design.fit.cascade.response(w); }});
  stages.push_back(
      {"sections", "cascade", [&design](RadPerSecond w) { return design.sections().response(w); }});
  if (design.plan) {
    stages.push_back(
        {"fpaa", "sections", [&design](RadPerSecond w) { return plan_response(*design.plan, w, false); }});
    stages.push_back({"fpaa with holds", "fpaa",
                      [&design](RadPerSecond w) { return plan_response(*design.plan, w, true); }});
  }
  if (design.circuit) {
    stages.push_back(
        {"circuit", "sections", [&design](RadPerSecond w) { return design.circuit->circuit.response(w); }});
    stages.push_back(
        {"circuit with op-amps", "circuit", [&design](RadPerSecond w) {
           return network_response(design.circuit->circuit, {w.hz()}, design.circuit->circuit.model).front();
         }});
  }
  return stages;
}

Budget make_budget(const Project& project, const Design& design) {
  Budget budget;
  budget.band = design_band(project, design);
  const std::vector<Hertz> grid = log_grid(budget.band, 240);
  const Disturbance& disturbance = project.target.disturbance;
  WaveformErrorOptions options;
  options.path = compensated_path(project);
  const auto waveform = [&](const FrequencyResponse& g) {
    return waveform_error(g, disturbance, project.track.frequency, options);
  };

  std::vector<std::vector<Complex>> responses;
  const std::vector<DesignStage> stages = design_stages(design);
  for (const DesignStage& stage : stages) {
    stop_if_interrupted();
    BudgetRow row;
    row.stage = stage.name;
    row.previous = stage.previous;
    std::vector<Complex> response;
    for (const Hertz f : grid) response.push_back(stage.response(f.rad_s()));
    for (size_t i = 0; i < responses.size(); ++i) {
      if (stages[i].name == stage.previous)
        row.against_previous = compare_responses(grid, response, responses[i]);
    }
    responses.push_back(std::move(response));
    for (const BodePoint& point : project.target.points.points) {
      // The base is a consequence of the fit, not a condition (contract).
      if (point.frequency <= project.target.base) continue;
      const double got = to_decibel(std::abs(stage.response(point.frequency.rad_s())));
      row.points_max_db = std::max(row.points_max_db, std::abs(got - to_decibel(point.gain)));
    }
    row.waveform = waveform(stage.response);
    budget.rows.push_back(std::move(row));
  }

  budget.uncompensated = waveform([](RadPerSecond) { return Complex(1.0); });
  // e(k) = (k - K) d: the squared error is a parabola in k, so three values give the best gain.
  const auto square_sum = [&](double k) {
    double sum = 0.0;
    for (const WaveformErrorPoint& point : waveform([k](RadPerSecond) { return Complex(k); }).points) {
      sum += point.rms_percent * point.rms_percent;
    }
    return sum;
  };
  const double at0 = square_sum(0.0);
  const double at1 = square_sum(1.0);
  const double at2 = square_sum(2.0);
  const double curvature = at0 - 2.0 * at1 + at2;
  budget.constant_gain = curvature > 0.0 ? 1.0 - 0.5 * (at2 - at0) / curvature : 1.0;
  budget.constant = waveform([&budget](RadPerSecond) { return Complex(budget.constant_gain); });
  budget.magnitude_only_is_worse =
      budget.rows.front().waveform.worst_percent > budget.uncompensated.worst_percent;
  return budget;
}

}  // namespace bodesmith::project
