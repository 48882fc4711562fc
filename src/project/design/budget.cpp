#include "project/design/budget.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "lti/judge_responses.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::project {
namespace {

/// The constant gain of smallest squared waveform error. e(k) = (k - K) d: the squared error is a parabola in k,
/// so three values determine it.
template <class Waveform>
double best_constant_gain(const Waveform& waveform) {
  const auto square_sum = [&waveform](double k) {
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
  return curvature > 0.0 ? 1.0 - 0.5 * (at2 - at0) / curvature : 1.0;
}

struct PlotRange {
  double low = 0.0;
  double high = 0.0;
};

/// Smallest and largest of `values`, not narrower than `start`.
PlotRange range_of(const std::vector<double>& values, PlotRange start) {
  for (const double y : values) {
    start.low = std::min(start.low, y);
    start.high = std::max(start.high, y);
  }
  return start;
}

void fix_axis(report::Axis& axis, double from, double to) {
  axis.fixed = true;
  axis.from = from;
  axis.to = to;
}

/// The same design with another alternative chosen, made on the board and of the parts by itself; what cannot be made stays
/// empty, and why is added to `refused`. The one that is built already stays as it is.
Design with_alternative(const Project& project, const Design& design, AlternativeHardware& hardware,
                        std::size_t chosen, std::vector<std::string>& refused) {
  Design out = design;
  if (chosen == design.chosen) return out;
  out.chosen = chosen;
  out.plan.reset();
  out.circuit.reset();
  if (project.deadline.passed() && !hardware.is_made(chosen)) {
    refused.emplace_back("Not tried in the time given.");
    return out;
  }
  if (const auto& plan = hardware.compared_plan_of(chosen)) {
    if (const auto* refusal = refusal_of(*plan)) {
      refused.push_back("Not on the board: " + refusal->reason);
    } else {
      out.plan = std::get<fpaa::Plan>(*plan);
    }
  }
  if (const auto& circuit = hardware.circuit_of(chosen)) {
    if (const auto* refusal = refusal_of(*circuit)) {
      refused.push_back("Not of these parts: " + refusal->reason);
    } else {
      out.circuit = std::get<synthesis::BuildChoice>(*circuit);
    }
  }
  return out;
}

}  // namespace

Budget make_budget(const Project& project, const Design& design, const Budget* other) {
  WaveformErrorOptions options;
  options.path = compensated_path(project);
  const auto waveform = [&](const FrequencyResponse& g) {
    return waveform_error(g, project.target.disturbance, project.track.frequency, options);
  };
  Budget budget = other != nullptr ? *other : Budget();
  budget.rows.resize(std::min<std::size_t>(budget.rows.size(), 1));
  budget.band = design.band(project);
  const std::vector<DesignStage> stages = design_stages(project, design);
  for (std::size_t i = budget.rows.size(); i < stages.size(); ++i) {
    stop_if_interrupted();
    const DesignStage& stage = stages[i];
    BudgetRow row;
    row.stage = stage.name;
    if (stage.previous) {
      row.previous = stages[*stage.previous].name;
      row.against_previous =
          judge_responses(at_each(stage.response), at_each(stages[*stage.previous].response), budget.band);
    }
    row.points_max_db = max_error_at_points(project, stage.response);
    row.waveform = waveform(remembered(stage.response));
    budget.rows.push_back(std::move(row));
  }
  if (other != nullptr) return budget;
  budget.uncompensated = waveform([](RadPerSecond) { return Complex(1.0); });
  budget.constant_gain = best_constant_gain(waveform);
  budget.constant = waveform([&budget](RadPerSecond) { return Complex(budget.constant_gain); });
  budget.magnitude_only_is_worse =
      budget.rows.front().waveform.worst_percent > budget.uncompensated.worst_percent;
  return budget;
}

std::vector<Hertz> stages_grid(const Project& project, const Design& design) {
  const Band band = design.band(project);
  const double beyond = project.plant ? 10.0 : 2.0;
  return log_grid({Hertz{band.from.value / beyond}, Hertz{band.to.value * beyond}}, 241);
}

std::vector<report::Plot> stages_plots(const Project& project, const Design& design) {
  const std::vector<DesignStage> stages = design_stages(project, design);
  const Project::Target& target = project.target;
  report::BodePlot plot =
      stages_bode(stages, stages_grid(project, design), target.has_points() ? &target.points : nullptr);
  if (project.plant) {
    // What lies far outside (the notches of a sampled chain) must not flatten the curves that matter.
    const PlotRange db = range_of(plot.magnitude.series.front().y, {0.0, 0.0});
    const double margin = 0.25 * std::max(0.5, db.high - db.low);
    fix_axis(plot.magnitude.y, db.low - margin, db.high + margin);
    const PlotRange degrees = range_of(plot.phase.series.front().y, {-5.0, 5.0});
    fix_axis(plot.phase.y, 2.0 * degrees.low, 1.5 * degrees.high);
  }
  // Of a fractional transfer, which is known everywhere; else of a stage.
  const DesignStage& of = stages[project.plant || !design.fit ? 0 : 1];
  const bool known = target.fractional.has_value();
  const auto reference_db = [&](Hertz f) {
    return to_decibel(std::abs(known ? target.fractional->response(f.rad_s()) : of.response(f.rad_s())));
  };
  return {
      plot.magnitude, plot.phase,
      difference_plot(plot.magnitude, known ? "Error against the target" : "Difference from the " + of.name,
                      design.band(project), reference_db, known ? "" : of.name)};
}

std::vector<AlternativeStudy> study_alternatives(const Project& project, const Design& design,
                                                 const Budget& budget, AlternativeHardware& hardware) {
  std::vector<AlternativeStudy> out(design.alternatives.size());
  parallel_for(out.size(), thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    out[i].design = with_alternative(project, design, hardware, i, out[i].refused);
    out[i].budget = i == design.chosen ? budget : make_budget(project, out[i].design, &budget);
  });
  stop_if_interrupted();
  return out;
}

}  // namespace bodesmith::project
