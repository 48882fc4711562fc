#include "fpaa/sheets/board_netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/network/switched_network.hpp"
#include "fpaa/plan/plan_graph.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::fpaa {
namespace {

std::string subcircuit_name(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

/// One CAM, pins in1 … out p1 p2: its circuit, the same that its response is worked out of, and strays.
schematic::Subcircuit stage_subcircuit(const NetlistStage& stage, const NetlistParts& parts) {
  SwitchedCircuit circuit = circuit_of(switches_of(*stage.cam, stage.name));
  schematic::Subcircuit out{subcircuit_name(stage.name), circuit.inputs, {}, std::move(circuit.netlist)};
  out.comments = {fmt::format("{}: {} {}, {} Hz", stage.name, stage.cam->cam_name(), stage.cam->option,
                              rounded_text(stage.cam->clock_a.value, 7))};
  out.pins.push_back(circuit.output);
  for (const SwitchedCircuit::Phase& phase : circuit.phases) out.pins.push_back(phase.node);
  schematic::Netlist& netlist = out.netlist;
  netlist.opamp = parts.opamp;
  netlist.analog_switch = schematic::SwitchModel::plain(parts.switch_on_ohm, 1.0 / parts.switch_off_ohm);
  std::set<std::string> stray;  // inverting inputs and nodes behind switches
  for (schematic::Part& one : netlist.parts) {
    one.realised *= parts.unit_capacitance_f;
    for (const std::string& node : {one.from, one.to}) {
      if (node[0] == 'u') stray.insert(node);
    }
  }
  for (const schematic::OpAmp& one : netlist.opamps) stray.insert(one.minus);
  for (const std::string& node : stray)
    netlist.parts.push_back({schematic::Part::Kind::capacitor, "CY" + node, "", 0, node, "0", "", 0.0,
                             parts.stray_units * parts.unit_capacitance_f});
  return out;
}

}  // namespace

std::string output_node(const std::string& name) {
  return "o_" + subcircuit_name(name);
}

std::string switched_library(schematic::Subcircuit top, const std::string& what,
                             const std::vector<NetlistStage>& stages, const NetlistParts& parts,
                             const std::string& title) {
  schematic::SpiceLibrary out;
  out.title = title;
  out.written_by = fmt::format("bodesmith {}", kVersion);
  out.top = top.name;
  out.notes = {
      what + " as switched capacitors. Derived from public material, not tried on silicon.",
      fmt::format(
          "Assumed: unit capacitance {} F, switches {} ohm on and {} ohm off, stray capacitance of {} units.",
          rounded_text(parts.unit_capacitance_f), rounded_text(parts.switch_on_ohm),
          rounded_text(parts.switch_off_ohm), rounded_text(parts.stray_units))};
  std::map<double, std::size_t> clocks;
  for (const NetlistStage& stage : stages) clocks.emplace(stage.period_s, clocks.size() + 1);
  for (const auto& [period_s, number] : clocks) {
    for (const int phase : {1, 2}) {
      const std::string node = fmt::format("c{}p{}", number, phase);
      top.netlist.clock_phases.push_back({"V" + node, node, {1.0 / period_s}, phase, parts.gap});
    }
  }
  for (const NetlistStage& stage : stages) {
    out.subcircuits.push_back(stage_subcircuit(stage, parts));
    schematic::Instance one{out.subcircuits.back().name, 0, stage.inputs, out.subcircuits.back().name};
    one.nodes.push_back(stage.output);
    for (const int phase : {1, 2})
      one.nodes.push_back(fmt::format("c{}p{}", clocks.at(stage.period_s), phase));
    top.netlist.instances.push_back(std::move(one));
  }
  out.subcircuits.push_back(std::move(top));
  return schematic::spice_text(out);
}

std::string board_netlist(const Plan& plan, const NetlistParts& parts, const std::string& title) {
  const PlanGraph graph = value_or_throw(plan_graph(plan));
  const auto node_of = [&](const PlanGraph::Source& source) {
    if (!source.node) return std::string("in");
    return source.node == graph.output.node ? "out" : output_node(graph.nodes[*source.node].name);
  };
  std::vector<NetlistStage> stages;
  for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
    const auto& node = graph.nodes[n];
    NetlistStage& stage = stages.emplace_back(NetlistStage{node.name,
                                                           node.cam,
                                                           static_cast<double>(node.period) / graph.tick_rate,
                                                           {node.cam->input_count(), "0"},
                                                           node_of({n})});
    for (const PlanGraph::Input& input : node.inputs) stage.inputs[input.number - 1] = node_of(input.from);
  }
  schematic::Subcircuit board{"board", {"in", "out"}, {}, {}};
  if (!graph.output.node) board.netlist.expressions = {{"Bout", "out", "V(in)"}};
  NetlistParts own = parts;
  if (!plan.slow.opamp.is_ideal) own.opamp = plan.slow.opamp;
  if (plan.slow.switch_s > 0.0) own.switch_on_ohm = plan.slow.switch_s / parts.unit_capacitance_f;
  return switched_library(std::move(board), "The plan", stages, own, title);
}

std::string board_deck_options() {
  return ".options method=gear reltol=1e-4 abstol=1e-14 vntol=1e-8 chgtol=1e-15 gmin=1e-13";
}

std::string board_deck(const Plan& plan, const std::string& title) {
  constexpr double kMostPeriods = 5.0;
  constexpr double kLeastPeriods = 1.5;
  constexpr double kStepsAPhase = 4.0;
  constexpr double kMostClocks = 10e3;  ///< of the fastest clock in the run: a minute or two of ngspice
  const double fastest = *plan.clocks_hz().rbegin();
  const double middle = std::sqrt(plan.error.band.from.value * plan.error.band.to.value);
  const double frequency =
      std::max(middle, std::min(plan.error.band.to.value, kMostPeriods * fastest / kMostClocks));
  const double periods = std::clamp(kMostClocks * frequency / fastest, kLeastPeriods, kMostPeriods);
  const double amplitude = plan.max_input_v > 0.0 ? std::min(1.0, 0.9 * plan.max_input_v) : 1.0;
  return render_template("fpaa/board.cir",
                         {{"title", title},
                          {"amplitude_v", schematic::plain_number(amplitude)},
                          {"frequency_hz", schematic::plain_number(frequency)},
                          {"options", board_deck_options()},
                          {"step_s", schematic::plain_number(0.5 / (fastest * kStepsAPhase))},
                          {"stop_s", schematic::plain_number(periods / frequency)}});
}

}  // namespace bodesmith::fpaa
