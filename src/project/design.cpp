#include "project/design.hpp"

#include <algorithm>
#include <memory>
#include <variant>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "circuit/network.hpp"
#include "fpaa/multirate_response.hpp"
#include "project/alternative_hardware.hpp"

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
    const AlternativeHardware::Made& made = hardware.of(candidate);
    const Refusal* refusal = made.plan ? refusal_of(*made.plan) : nullptr;
    if (refusal == nullptr && made.circuit) refusal = refusal_of(*made.circuit);
    if (refusal == nullptr) {
      if (made.plan) design.plan = std::get<fpaa::Plan>(*made.plan);
      if (made.circuit) design.circuit = std::get<circuit::Realised>(*made.circuit);
      return;
    }
    last_reason = refusal->reason;
    design.passed_over.push_back(design.built().name + ": " + last_reason);
  }
  throw DesignError(last_reason);
}

}  // namespace

Band design_band(const Project& project, const Cascade& cascade, const Sections& sections) {
  Band band{project.target.points.points.front().frequency, project.target.points.points.back().frequency};
  const auto widen = [&band](const Band& other) {
    if (!(other.from.value > 0.0) || !(other.to >= other.from)) return;
    band.from = std::min(band.from, other.from);
    band.to = std::max(band.to, other.to);
  };
  if (!cascade.terms.empty()) widen(cascade.corner_band());
  widen(sections.corner_band());
  return band;
}

Band design_band(const Project& project, const Design& design) {
  return design_band(project, design.fit.cascade, design.sections());
}

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
  const AlternativeHardware::Made& made = hardware.of(chosen);
  if (made.plan) {
    if (const auto* refusal = refusal_of(*made.plan)) {
      refused.push_back("Not on the board: " + refusal->reason);
    } else {
      out.plan = std::get<fpaa::Plan>(*made.plan);
    }
  }
  if (made.circuit) {
    if (const auto* refusal = refusal_of(*made.circuit)) {
      refused.push_back("Not of these parts: " + refusal->reason);
    } else {
      out.circuit = std::get<circuit::Realised>(*made.circuit);
    }
  }
  return out;
}

Design make_design(const Project& project) {
  // Knows the disturbance alone: made beside everything else.
  auto controller = std::async(std::launch::async, [&] { return make_analog_controller(project); });
  return make_design(project, controller.share(), {});
}

Design make_design(const Project& project, const std::shared_future<AnalogControllerMade>& controller,
                   const AlternativesKnown& known) {
  const Stopwatch watch;
  Design design;
  design.fit = fit_cascade(project.target.points, fit_options(project));
  design.approximation = approximate_cascade(design.fit.cascade, approximation_options(project));
  if (design.approximation.sections.sections.empty()) {
    throw DesignError("the target's gains are all alike: no filter is needed, its gain is " +
                      rounded_text(design.approximation.sections.gain, 6) +
                      "; the controller without one is made by bodesmith controller DISTURBANCE.json");
  }
  const Stopwatch alternatives_watch;
  design.alternatives = make_alternatives(project, design.approximation);
  design.alternatives_s = alternatives_watch.seconds();
  const auto hardware = std::make_shared<AlternativeHardware>(project, design);
  if (known) known(hardware);
  build_best_alternative(project, *hardware, design);
  design.layout = multiplier_layout::make_layout(project.target.disturbance);
  design.controller = controller.get().controller;
  for (const std::string& form : controller.get().passed_over) design.passed_over.push_back(form);
  design.compute_s = watch.seconds() - design.alternatives_s;
  return design;
}

std::vector<DesignStage> design_stages(const Design& design) {
  std::vector<DesignStage> stages;
  const auto add = [&stages](std::string name, std::optional<std::size_t> previous, auto response) {
    stages.push_back({std::move(name), previous, std::move(response)});
    return stages.size() - 1;
  };
  const std::size_t cascade =
      add("cascade", std::nullopt, [&design](RadPerSecond w) { return design.fit.cascade.response(w); });
  const std::size_t sections =
      add("sections", cascade, [&design](RadPerSecond w) { return design.sections().response(w); });
  if (design.plan) {
    const auto response = std::make_shared<const fpaa::MultirateResponse>(*design.plan);
    const std::size_t fpaa =
        add("fpaa", sections, [response](RadPerSecond w) { return response->without_delays(w); });
    add("fpaa with holds", fpaa, [response](RadPerSecond w) { return response->as_it_runs(w); });
  }
  if (design.circuit) {
    const std::size_t circuit =
        add("circuit", sections, [&design](RadPerSecond w) { return design.circuit->circuit.response(w); });
    const auto network = std::make_shared<const circuit::Network>(design.circuit->circuit);
    add("circuit with op-amps", circuit,
        [network](RadPerSecond w) { return network->output(w, &network->circuit().model); });
  }
  return stages;
}

}  // namespace bodesmith::project
