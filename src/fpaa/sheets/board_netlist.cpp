#include "fpaa/sheets/board_netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/network/switched_network.hpp"
#include "fpaa/plan/plan_graph.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kEdgeOfGap = 0.25;  ///< an edge of a phase, as a share of the gap
constexpr double kPolePart = 1e-11;  ///< F: about the others, gm follows; ngspice's chgtol is one for all

/// Digits that every simulator reads: no unit letters.
std::string spice_number(double value) {
  return fmt::format("{:.9g}", value);
}

/// The lines of one CAM's subcircuit, pins in1 … out p1 p2: its network, the same that its response is worked out of.
std::vector<std::string> stage_lines(const StageSwitches& stage, const NetlistParts& parts) {
  const SwitchedNetwork network = network_of(stage);
  std::vector<std::string> names{"0"};
  for (int node = 1; node < network.nodes; ++node) names.push_back(fmt::format("u{}", node));
  const auto name = [&](int node) -> std::string& { return names[static_cast<std::size_t>(node)]; };
  for (std::size_t i = 0; i < network.inputs.size(); ++i)
    name(network.inputs[i]) = fmt::format("in{}", i + 1);
  for (std::size_t k = 0; k < network.opamps.size(); ++k) {
    name(network.opamps[k].minus) = fmt::format("n{}", k + 1);
    const bool is_output = static_cast<int>(k) == network.output;
    name(network.opamps[k].out) = is_output ? "out" : fmt::format("a{}", k + 1);
  }
  std::vector<std::string> out;
  const double gm = 2.0 * std::numbers::pi * parts.opamp.gain_bandwidth.value * kPolePart;
  for (std::size_t k = 1; k <= network.opamps.size(); ++k) {
    const SwitchedNetwork::OpAmp& amp = network.opamps[k - 1];
    out.push_back(fmt::format("GA{0} x{0} 0 {1} 0 {2}", k, name(amp.minus), spice_number(gm)));
    out.push_back(fmt::format("CA{0} x{0} 0 {1}", k, spice_number(kPolePart)));
    out.push_back(fmt::format("RA{0} x{0} 0 {1}", k, spice_number(parts.opamp.gain / gm)));
    out.push_back(fmt::format("EA{0} {1} 0 x{0} 0 1", k, name(amp.out)));
  }
  for (std::size_t s = 1; s <= network.switches.size(); ++s) {
    const SwitchedNetwork::Switch& at = network.switches[s - 1];
    out.push_back(fmt::format("GS{0} {1} {2} VALUE={{V({1},{2})*V(p{3})*{4}}}", s, name(at.a), name(at.b),
                              at.phase, spice_number(1.0 / parts.switch_on_ohm)));
    out.push_back(
        fmt::format("RS{} {} {} {}", s, name(at.a), name(at.b), spice_number(parts.switch_off_ohm)));
  }
  for (const SwitchedNetwork::Capacitor& c : network.capacitors) {
    out.push_back(fmt::format("C{} {} {} {}", c.name, name(c.a), name(c.b),
                              spice_number(c.size * parts.unit_capacitance_f)));
  }
  for (const std::string& node : names) {
    if (node[0] != 'u' && node[0] != 'n') continue;
    out.push_back(
        fmt::format("CY{0} {0} 0 {1}", node, spice_number(parts.stray_units * parts.unit_capacitance_f)));
  }
  return out;
}

Json board_clock_json(std::size_t number, double period, const NetlistParts& parts) {
  const double gap = parts.gap * period;
  const double edge = kEdgeOfGap * gap;
  // Edges lie inside the gaps: a phase is full from its beginning to its end.
  return {{"number", number},
          {"frequency_hz", spice_number(1.0 / period)},
          {"period_s", spice_number(period)},
          {"edge_s", spice_number(edge)},
          {"delay1_s", spice_number(0.0)},
          {"width1_s", spice_number(0.5 * period - gap)},
          {"delay2_s", spice_number(0.5 * period)},
          {"width2_s", spice_number(period - 0.5 * period - gap)}};
}

std::string subcircuit_name(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

}  // namespace

std::string output_node(const std::string& name) {
  return "o_" + subcircuit_name(name);
}

std::string switched_library(const std::string& top, const std::string& what,
                             const std::vector<NetlistStage>& stages, const std::vector<std::string>& links,
                             const NetlistParts& parts, const std::string& title) {
  std::map<double, std::size_t> clocks;
  for (const NetlistStage& stage : stages) clocks.emplace(stage.period_s, clocks.size() + 1);
  Json data{{"title", title},
            {"version", kVersion},
            {"top", top},
            {"what", what},
            {"unit_f", spice_number(parts.unit_capacitance_f)},
            {"on_ohm", spice_number(parts.switch_on_ohm)},
            {"off_ohm", spice_number(parts.switch_off_ohm)},
            {"stray_units", spice_number(parts.stray_units)},
            {"bandwidth_hz", spice_number(parts.opamp.gain_bandwidth.value)},
            {"gain", spice_number(parts.opamp.gain)},
            {"clocks", Json::array()},
            {"cams", Json::array()},
            {"links", links}};
  for (const auto& [period_s, number] : clocks)
    data["clocks"].push_back(board_clock_json(number, period_s, parts));
  for (const NetlistStage& stage : stages) {
    std::string pins;
    for (std::size_t i = 1; i <= stage.inputs.size(); ++i) pins += fmt::format("in{} ", i);
    const std::size_t clock = clocks.at(stage.period_s);
    data["cams"].push_back({{"name", stage.name},
                            {"what", fmt::format("{} {}, {} Hz", stage.cam->cam_name(), stage.cam->option,
                                                 rounded_text(stage.cam->clock_a.value, 7))},
                            {"subcircuit", subcircuit_name(stage.name)},
                            {"pins", pins + "out p1 p2"},
                            {"nodes", fmt::format("{} {} c{}p1 c{}p2", join(stage.inputs, " "),
                                                  output_node(stage.name), clock, clock)},
                            {"elements", stage_lines(switches_of(*stage.cam, stage.name), parts)}});
  }
  return render_template("fpaa/board.sub", data);
}

std::string board_netlist(const Plan& plan, const NetlistParts& parts, const std::string& title) {
  const PlanGraph graph = value_or_throw(plan_graph(plan));
  if (!graph.output) throw DesignError("no wire leads to an output pin, expected one");
  const auto node_of = [&](const PlanGraph::Source& source) {
    return source.node ? output_node(graph.nodes[*source.node].name) : "in";
  };
  std::vector<NetlistStage> stages;
  for (const auto& node : graph.nodes) {
    NetlistStage& stage = stages.emplace_back(NetlistStage{node.name,
                                                           node.cam,
                                                           static_cast<double>(node.period) / graph.tick_rate,
                                                           {node.cam->input_count(), "0"}});
    for (const PlanGraph::Input& input : node.inputs) stage.inputs[input.number - 1] = node_of(input.from);
  }
  return switched_library("board in out", "the plan", stages,
                          {fmt::format("Eout out 0 {} 0 1", node_of(*graph.output))}, parts, title);
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
  return render_template("fpaa/board.cir", {{"title", title},
                                            {"amplitude_v", spice_number(amplitude)},
                                            {"frequency_hz", spice_number(frequency)},
                                            {"options", board_deck_options()},
                                            {"step_s", spice_number(0.5 / (fastest * kStepsAPhase))},
                                            {"stop_s", spice_number(periods / frequency)}});
}

}  // namespace bodesmith::fpaa
