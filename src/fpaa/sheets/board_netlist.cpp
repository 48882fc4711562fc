#include "fpaa/sheets/board_netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/plan_graph.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kEdgeOfGap = 0.25;  ///< an edge of a phase, as a share of the gap
constexpr double kPolePart = 1e-11;  ///< F: about the others, gm follows; ngspice's chgtol is one for all

/// Digits that every simulator reads: no unit letters.
std::string spice_number(double value) {
  return fmt::format("{:.9g}", value);
}

/// The lines of one CAM's subcircuit: pins in1 … out p1 p2.
class StageWriter {
 public:
  explicit StageWriter(const NetlistParts& parts) : parts_(parts) {}

  std::vector<std::string> lines(const StageSwitches& stage) {
    for (std::size_t k = 0; k < stage.opamps.size(); ++k) add_opamp(stage, k);
    for (std::size_t c = 0; c < stage.capacitors.size(); ++c) add_capacitor(stage, c);
    return std::move(lines_);
  }

 private:
  static std::string output_node(const StageSwitches& stage, int opamp) {
    return opamp == stage.output ? "out" : fmt::format("a{}", opamp);
  }
  static std::string node_name(const StageSwitches& stage, const PlateNode& node) {
    switch (node.kind) {
      case PlateNode::Kind::input:
        return fmt::format("in{}", node.number);
      case PlateNode::Kind::opamp:
        return output_node(stage, node.number);
      case PlateNode::Kind::virtual_ground:
        return fmt::format("n{}", node.number);
      case PlateNode::Kind::open:
      case PlateNode::Kind::ground:
        break;
    }
    return "0";
  }

  void add_switch(const std::string& from, const std::string& to, int phase) {
    ++switches_;
    lines_.push_back(fmt::format("GS{} {} {} VALUE={{V({},{})*V(p{})*{}}}", switches_, from, to, from, to,
                                 phase, spice_number(1.0 / parts_.switch_on_ohm)));
    lines_.push_back(fmt::format("RS{} {} {} {}", switches_, from, to, spice_number(parts_.switch_off_ohm)));
  }

  /// Where a plate's capacitor ends: at a fixed node, or at a node of its own behind switches.
  std::string plate_node(const StageSwitches& stage, const Plate& plate, const std::string& own) {
    if (plate.is_static()) return node_name(stage, plate.phase1);
    if (plate.phase1.kind != PlateNode::Kind::open) add_switch(node_name(stage, plate.phase1), own, 1);
    if (plate.phase2.kind != PlateNode::Kind::open) add_switch(node_name(stage, plate.phase2), own, 2);
    add_stray(own);
    return own;
  }

  void add_stray(const std::string& node) {
    lines_.push_back(
        fmt::format("CY{0} {0} 0 {1}", node, spice_number(parts_.stray_units * parts_.unit_capacitance_f)));
  }

  void add_opamp(const StageSwitches& stage, std::size_t index) {
    const int k = static_cast<int>(index) + 1;
    const double gm = 2.0 * std::numbers::pi * parts_.opamp.gain_bandwidth.value * kPolePart;
    lines_.push_back(fmt::format("GA{0} x{0} 0 n{0} 0 {1}", k, spice_number(gm)));
    lines_.push_back(fmt::format("CA{0} x{0} 0 {1}", k, spice_number(kPolePart)));
    lines_.push_back(fmt::format("RA{0} x{0} 0 {1}", k, spice_number(parts_.opamp.gain / gm)));
    lines_.push_back(fmt::format("EA{0} {1} 0 x{0} 0 1", k, output_node(stage, k)));
    add_stray(fmt::format("n{}", k));
    const int reset = stage.opamps[index].reset_phase;
    if (reset != 0) add_switch(output_node(stage, k), fmt::format("n{}", k), reset);
  }

  void add_capacitor(const StageSwitches& stage, std::size_t index) {
    const StageCapacitor& c = stage.capacitors[index];
    if (!(c.units > 0.0)) return;
    const std::string near = plate_node(stage, c.near, fmt::format("u{}", index + 1));
    const std::string far = plate_node(stage, c.far, fmt::format("w{}", index + 1));
    lines_.push_back(
        fmt::format("C{} {} {} {}", c.name, near, far, spice_number(c.units * parts_.unit_capacitance_f)));
  }

  const NetlistParts& parts_;
  std::vector<std::string> lines_;
  int switches_ = 0;
};

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

Json line_list(const std::vector<std::string>& lines) {
  Json out = Json::array();
  for (const std::string& line : lines) out.push_back({{"line", line}});
  return out;
}

std::string source_name(const PlanGraph& graph, const PlanGraph::Source& source) {
  return source.node ? "o_" + subcircuit_name(graph.nodes[*source.node].name) : "in";
}

}  // namespace

Outcome<std::string> board_netlist(const Plan& plan, const NetlistParts& parts, const std::string& title) {
  const Outcome<PlanGraph> wired = plan_graph(plan);
  if (const Refusal* refusal = refusal_of(wired)) return *refusal;
  const PlanGraph& graph = std::get<PlanGraph>(wired);
  std::map<std::int64_t, std::size_t> clocks;
  for (const auto& node : graph.nodes) clocks.emplace(node.period, clocks.size() + 1);
  Json data{{"title", title},
            {"version", kVersion},
            {"unit_f", spice_number(parts.unit_capacitance_f)},
            {"on_ohm", spice_number(parts.switch_on_ohm)},
            {"off_ohm", spice_number(parts.switch_off_ohm)},
            {"stray_units", spice_number(parts.stray_units)},
            {"bandwidth_hz", spice_number(parts.opamp.gain_bandwidth.value)},
            {"gain", spice_number(parts.opamp.gain)},
            {"clocks", Json::array()},
            {"cams", Json::array()},
            {"links", Json::array()}};
  for (const auto& [period, number] : clocks) {
    data["clocks"].push_back(board_clock_json(number, static_cast<double>(period) / graph.tick_rate, parts));
  }
  for (const auto& node : graph.nodes) {
    const PlacedCam& cam = *node.cam;
    const auto stage = cam.cam->switches(cam);
    if (!stage) {
      return Refusal{
          fmt::format("the switches of {} ({}) are not known, expected only CAMs made of switched capacitors",
                      node.name, cam.cam_name())};
    }
    std::string pins;
    std::string nodes;
    for (std::size_t i = 1; i <= cam.input_count(); ++i) {
      pins += fmt::format("in{} ", i);
      const auto input = std::find_if(node.inputs.begin(), node.inputs.end(),
                                      [&](const PlanGraph::Input& one) { return one.number == i; });
      nodes += (input == node.inputs.end() ? "0" : source_name(graph, input->from)) + " ";
    }
    const std::string name = subcircuit_name(node.name);
    const std::size_t clock = clocks.at(node.period);
    data["cams"].push_back({{"name", node.name},
                            {"what", fmt::format("{} {}, {} Hz", cam.cam_name(), cam.option,
                                                 rounded_text(cam.clock_a.value, 7))},
                            {"subcircuit", name},
                            {"pins", pins + "out p1 p2"},
                            {"nodes", nodes + fmt::format("o_{0} c{1}p1 c{1}p2", name, clock)},
                            {"elements", line_list(StageWriter(parts).lines(*stage))}});
  }
  if (!graph.output) return Refusal{"no wire leads to an output pin, expected one"};
  data["links"] = line_list({fmt::format("Eout out 0 {} 0 1", source_name(graph, *graph.output))});
  return render_template("fpaa/board.sub", data);
}

std::string board_deck_options() {
  return ".options method=gear reltol=1e-4 abstol=1e-14 vntol=1e-8 chgtol=1e-15 gmin=1e-13";
}

std::string board_deck(const Plan& plan, const std::string& title) {
  constexpr double kMostPeriods = 5.0;
  constexpr double kLeastPeriods = 1.5;
  constexpr double kStepsAPhase = 4.0;
  constexpr double kMostClocks = 10e3;  ///< of the fastest clock in the run: a minute or two of ngspice
  double fastest = 0.0;
  for (const PlacedCam* cam : plan.cams()) fastest = std::max(fastest, cam->clock_a.value);
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
