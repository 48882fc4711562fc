#include "project/design/design.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "fit/choice.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "schematic/analysis/equations.hpp"

namespace bodesmith::project {
namespace {

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

/// Builds the best alternative that the hardware can make.
void build_best_alternative(const Project& project, AlternativeHardware& hardware, Design& design) {
  std::string last_reason;
  for (const std::size_t candidate : rank_alternatives(project, design.alternatives)) {
    design.chosen = candidate;
    // Parts first: what they cannot make needs no search for a board.
    const auto& circuit = hardware.circuit_of(candidate);
    const Refusal* refusal = circuit ? refusal_of(*circuit) : nullptr;
    if (refusal == nullptr) {
      const auto& plan = hardware.plan_of(candidate);
      refusal = plan ? refusal_of(*plan) : nullptr;
      if (refusal == nullptr) {
        if (plan) design.plan = std::get<fpaa::Plan>(*plan);
        if (circuit) design.circuit = std::get<synthesis::BuildChoice>(*circuit);
        return;
      }
    }
    last_reason = refusal->reason;
    design.passed_over.push_back(design.built().name + ": " + last_reason);
  }
  throw DesignError(last_reason);
}

}  // namespace

Band design_band(const Project& project, const Design& design) {
  return design_band(project, design.fit.cascade, design.sections());
}

Design make_alternative_designs(const Project& project) {
  const Stopwatch watch;
  Design design;
  ChartedFit charted = fit_by_chart(project.target.points, fit_options(project));
  design.fit = std::move(charted.fit);
  design.fit.warnings.insert(design.fit.warnings.end(), charted.steps.begin(), charted.steps.end());
  design.approximation = approximate_cascade(design.fit.cascade, approximation_options(project));
  if (design.approximation.sections.sections.empty()) {
    throw DesignError("the target's gains are all alike: no filter is needed, its gain is " +
                      rounded_text(design.approximation.sections.gain, 6) +
                      "; the controller without one is made by bodesmith controller DISTURBANCE.json");
  }
  design.compute_s = watch.seconds();
  const Stopwatch alternatives_watch;
  design.alternatives = make_alternatives(project, design.approximation);
  design.alternatives_s = alternatives_watch.seconds();
  return design;
}

void choose_alternative(const Project& project, AlternativeHardware& hardware, Design& design) {
  const Stopwatch watch;
  build_best_alternative(project, hardware, design);
  design.paper_plan = make_paper_plan(project, design.approximation.sections, design_band(project, design));
  design.layout = generator::make_layout(project.target.disturbance);
  design.compute_s += watch.seconds();
}

void add_controller(const AnalogControllerMade& made, Design& design) {
  design.controller = made.controller;
  design.passed_over.insert(design.passed_over.end(), made.passed_over.begin(), made.passed_over.end());
}

Design make_design(const Project& project) {
  Design design = make_alternative_designs(project);
  AlternativeHardware hardware(project, design.fit.cascade, design.alternatives);
  choose_alternative(project, hardware, design);
  add_controller(make_analog_controller(project), design);
  return design;
}

std::vector<DesignStage> design_stages(const Design& design) {
  std::vector<DesignStage> stages;
  const auto add = [&stages](std::string name, std::optional<std::size_t> previous, auto response) {
    stages.push_back({std::move(name), std::move(response), previous});
    return stages.size() - 1;
  };
  const std::size_t cascade =
      add("cascade", std::nullopt, [&design](RadPerSecond w) { return design.fit.cascade.response(w); });
  const std::size_t sections =
      add("sections", cascade, [&design](RadPerSecond w) { return design.sections().response(w); });
  if (design.plan) {
    const auto response = std::make_shared<const fpaa::SwitchedBoard>(*design.plan);
    const std::size_t fpaa =
        add("fpaa", sections, [response](RadPerSecond w) { return response->sampled(w); });
    add("fpaa with holds", fpaa, [response](RadPerSecond w) { return response->gain(w); });
  }
  if (design.circuit) {
    const std::size_t circuit =
        add("circuit", sections, [&design](RadPerSecond w) { return design.realised().circuit.response(w); });
    const auto network = std::make_shared<const schematic::Equations>(design.realised().circuit);
    add("circuit with op-amps", circuit, [network](RadPerSecond w) { return network->response(w); });
  }
  return stages;
}

}  // namespace bodesmith::project
