#include "project/design/design.hpp"

#include "base/error.hpp"
#include "base/progress.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "schematic/analysis/equations.hpp"
#include "tolerance/design.hpp"

namespace bodesmith::project {
namespace {

constexpr std::uint64_t kYieldSamples = 20000;
constexpr int kYieldPoints = 60;

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

void choose_alternative(const Project& project, AlternativeHardware& hardware, Design& design) {
  const Stopwatch watch;
  if (project.plant) {
    build_best_alternative(project, hardware, design);
    design.paper_plan = make_paper_plan(project, design.approximation->sections, design.band(project));
    design.layout = generator::make_layout(project.target.disturbance);
  } else {
    // The board's search first: add_tolerances() makes the circuit meanwhile.
    if (const auto& plan = hardware.plan_of(0)) {
      if (const Refusal* refusal = refusal_of(*plan)) {
        design.no_plan = refusal->reason;
      } else {
        design.plan = std::get<fpaa::Plan>(*plan);
      }
    }
    if (const auto& circuit = hardware.circuit_of(0)) design.circuit = value_or_throw(*circuit);
  }
  design.compute_s += watch.seconds();
}

void add_tolerances(const Project& project, AlternativeHardware& hardware, Design& design) {
  if (!project.circuit) return;
  if (project.deadline.passed()) {
    design.not_tried.emplace_back("tolerances");
    return;
  }
  const tolerance::Design built = tolerance::design_of_circuit(
      value_or_throw(*hardware.circuit_of(0)).best.made.circuit,
      stating_band(design.sections(), project.target.band), project.name, tolerance::OpAmps::as_built);
  tolerance::Options options;
  options.spread = project.spread;
  options.samples = kYieldSamples;
  options.grid = judging_grid(built.wanted, project.target.band, kYieldPoints);
  tolerance::leave_out_nulls({built}, options.grid);
  options.limit_db = project.limits.yield_db;
  design.yield = tolerance::run_monte_carlo(built, options, Team());
}

void add_controller(const AnalogControllerMade& made, Design& design) {
  design.controller = made.controller;
  design.passed_over.insert(design.passed_over.end(), made.passed_over.begin(), made.passed_over.end());
}

std::vector<DesignStage> design_stages(const Project& project, const Design& design) {
  std::vector<DesignStage> stages;
  const auto add = [&stages](std::string name, std::optional<std::size_t> previous, auto response) {
    stages.push_back({std::move(name), std::move(response), previous});
    return stages.size() - 1;
  };
  std::optional<std::size_t> cascade;
  if (design.fit)
    cascade =
        add("cascade", std::nullopt, [&design](RadPerSecond w) { return design.fit->cascade.response(w); });
  const std::size_t sections =
      add("sections", cascade, [&design](RadPerSecond w) { return design.sections().response(w); });
  std::size_t hardware = sections;
  if (design.plan) {
    const auto board = std::make_shared<const fpaa::SwitchedBoard>(*design.plan);
    if (project.plant)
      hardware = add("fpaa", sections, [board](RadPerSecond w) { return board->sampled(w); });
    add(project.plant ? "fpaa with holds" : "FPAA as it runs", hardware,
        [board](RadPerSecond w) { return board->gain(w); });
  }
  if (design.circuit) {
    hardware = sections;
    if (project.plant)
      hardware = add("circuit", sections,
                     [&design](RadPerSecond w) { return design.realised().circuit.response(w); });
    const auto network = std::make_shared<const schematic::Equations>(design.realised().circuit);
    add("circuit with op-amps", hardware, [network](RadPerSecond w) { return network->response(w); });
  }
  return stages;
}

}  // namespace bodesmith::project
