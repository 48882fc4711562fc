#include "project/design.hpp"

#include <algorithm>
#include <future>
#include <memory>
#include <variant>

#include "base/error.hpp"
#include "base/outcome.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "circuit/network.hpp"
#include "fpaa/multirate_response.hpp"
#include "project/built_controllers.hpp"

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

/// What the chosen sections are made of.
struct Hardware {
  std::optional<fpaa::Plan> plan;
  std::optional<circuit::Realised> circuit;
};

fpaa::PlanOptions plan_options(const Project& project, const Band& band) {
  fpaa::PlanOptions options;
  options.board = project.fpaa->board;
  options.clock = project.fpaa->clock;
  options.band = band;
  return options;
}

circuit::RealiseOptions circuit_options(const Project& project) {
  circuit::RealiseOptions options;
  options.realisation = project.circuit->realisation;
  options.resistors = circuit::Series::named(project.circuit->resistors);
  options.capacitors = circuit::Series::named(project.circuit->capacitors);
  return options;
}

Outcome<fpaa::Plan> try_plan(const Project& project, const Sections& sections, const Band& band) {
  try {
    return fpaa::make_plan(sections, plan_options(project, band));
  } catch (const DesignError& error) {
    return Refusal{error.what()};
  }
}

/// Plan and circuit of `sections`, or the reason why the board or the parts cannot make them.
Outcome<Hardware> build_hardware(const Project& project, const Sections& sections, const Band& band) {
  try {
    Hardware out;
    // The plan's search takes longest: parts are looked for beside it.
    std::future<Outcome<fpaa::Plan>> planned;
    if (project.fpaa)
      planned = std::async(std::launch::async, [&] { return try_plan(project, sections, band); });
    std::optional<Outcome<circuit::Realised>> parts;
    if (project.circuit) parts = circuit::try_realise(sections, circuit_options(project));
    if (planned.valid()) {
      auto plan = planned.get();
      if (const auto* refusal = refusal_of(plan)) return *refusal;
      out.plan = std::get<fpaa::Plan>(std::move(plan));
    }
    if (parts) {
      if (const auto* refusal = refusal_of(*parts)) return *refusal;
      out.circuit = std::get<circuit::Realised>(std::move(*parts));
    }
    return out;
  } catch (const DesignError& error) {
    return Refusal{error.what()};
  }
}

/// Builds the best alternative that the hardware can make.
void build_best_alternative(const Project& project, Design& design) {
  std::string last_reason;
  for (const std::size_t candidate : rank_alternatives(project, design.alternatives)) {
    design.chosen = candidate;
    auto made = build_hardware(project, design.sections(), design_band(project, design));
    if (auto* hardware = std::get_if<Hardware>(&made)) {
      design.plan = std::move(hardware->plan);
      design.circuit = std::move(hardware->circuit);
      return;
    }
    last_reason = std::get<Refusal>(made).reason;
    design.passed_over.push_back(design.built().name + ": " + last_reason);
  }
  throw DesignError(last_reason);
}

}  // namespace

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

Design with_alternative(const Project& project, const Design& design, std::size_t chosen,
                        std::vector<std::string>& refused) {
  Design out = design;
  if (chosen == design.chosen) return out;
  out.chosen = chosen;
  out.plan.reset();
  out.circuit.reset();
  if (project.deadline.passed()) {
    refused.emplace_back("Not tried in the time given.");
    return out;
  }
  if (project.fpaa) {
    auto plan = try_plan(project, out.sections(), design_band(project, out));
    if (const auto* refusal = refusal_of(plan)) {
      refused.push_back("Not on the board: " + refusal->reason);
    } else {
      out.plan = std::get<fpaa::Plan>(std::move(plan));
    }
  }
  if (project.circuit) {
    auto circuit = circuit::try_realise(out.sections(), circuit_options(project));
    if (const auto* refusal = refusal_of(circuit)) {
      refused.push_back("Not of these parts: " + refusal->reason);
    } else {
      out.circuit = std::get<circuit::Realised>(std::move(circuit));
    }
  }
  return out;
}

Design make_design(const Project& project) {
  const Stopwatch watch;
  // Knows the disturbance alone: made beside everything else.
  std::vector<std::string> forms_passed_over;
  auto controller =
      std::async(std::launch::async, [&] { return make_analog_controller(project, forms_passed_over); });
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
  build_best_alternative(project, design);
  design.layout = multiplier_layout::make_layout(project.target.disturbance);
  design.controller = controller.get();
  for (std::string& form : forms_passed_over) design.passed_over.push_back(std::move(form));
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
