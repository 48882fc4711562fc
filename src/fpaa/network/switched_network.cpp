#include "fpaa/network/switched_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.hpp"

namespace bodesmith::fpaa {
namespace {

/// Nodes of a stage's circuit as they are asked for.
class StageNodes {
 public:
  StageNodes(const StageSwitches& stage, const SlowParts& slow) {
    circuit.netlist.opamp = slow.opamp;
    circuit.switch_s = slow.switch_s;
    int clocks = 1;
    for (const StageCapacitor& c : stage.capacitors)
      clocks = std::max({clocks, c.near.clock + 1, c.far.clock + 1});
    for (const StageOpAmp& one : stage.opamps) clocks = std::max(clocks, one.reset_clock + 1);
    for (int clock = 0; clock < clocks; ++clock) {
      for (const int phase : {1, 2})
        circuit.phases.push_back({fmt::format("p{}", 2 * clock + phase), clock, phase});
    }
    for (int i = 1; i <= stage.inputs(); ++i) circuit.inputs.push_back(fmt::format("in{}", i));
    circuit.output = "out";
    for (int k = 1; k <= static_cast<int>(stage.opamps.size()); ++k) {
      circuit.netlist.opamps.push_back({fmt::format("A{}", k), "", 0, "0", fmt::format("n{}", k),
                                        k == stage.output ? circuit.output : fmt::format("a{}", k)});
    }
  }

  std::string node(const PlateNode& plate) const {
    const auto index = static_cast<std::size_t>(plate.number - 1);
    switch (plate.kind) {
      case PlateNode::Kind::input:
        return circuit.inputs[index];
      case PlateNode::Kind::opamp:
        return circuit.netlist.opamps[index].out;
      case PlateNode::Kind::virtual_ground:
        return circuit.netlist.opamps[index].minus;
      case PlateNode::Kind::open:
      case PlateNode::Kind::ground:
        break;
    }
    return "0";
  }

  /// A node that is always the same, or one of its own behind switches.
  std::string plate(const Plate& plate) {
    if (plate.is_static() && plate.phase1.kind != PlateNode::Kind::open) return node(plate.phase1);
    std::string own = fmt::format("u{}", ++own_nodes_);
    if (plate.phase1.kind != PlateNode::Kind::open) contact(own, node(plate.phase1), plate.clock, 1);
    if (plate.phase2.kind != PlateNode::Kind::open) contact(own, node(plate.phase2), plate.clock, 2);
    return own;
  }

  void contact(const std::string& from, const std::string& to, int clock, int phase) {
    circuit.netlist.contacts.push_back(
        {fmt::format("S{}", circuit.netlist.contacts.size() + 1), 0, from, to,
         circuit.phases[static_cast<std::size_t>(2 * clock + phase - 1)].node});
  }

  SwitchedCircuit circuit;

 private:
  int own_nodes_ = 0;
};

}  // namespace

SwitchedCircuit circuit_of(const StageSwitches& stage, const SlowParts& slow) {
  StageNodes out(stage, slow);
  for (const StageCapacitor& c : stage.capacitors) {
    if (!(c.units > 0.0)) continue;
    const std::string near = out.plate(c.near), far = out.plate(c.far);
    out.circuit.netlist.parts.push_back(
        {schematic::Part::Kind::capacitor, "C" + c.name, "", 0, near, far, "", c.units, c.units});
  }
  for (std::size_t k = 0; k < stage.opamps.size(); ++k) {
    const StageOpAmp& one = stage.opamps[k];
    const schematic::OpAmp& amp = out.circuit.netlist.opamps[k];
    if (one.reset_phase != 0) out.contact(amp.minus, amp.out, one.reset_clock, one.reset_phase);
  }
  return std::move(out.circuit);
}

SwitchedNetwork::SwitchedNetwork(const SwitchedCircuit& circuit) : switch_s(circuit.switch_s) {
  const schematic::Netlist& netlist = circuit.netlist;
  std::map<std::string, int> numbers{{"0", 0}};
  const auto node = [&](const std::string& name) {
    return numbers.try_emplace(name, static_cast<int>(numbers.size())).first->second;
  };
  for (const std::string& input : circuit.inputs) inputs.push_back(node(input));
  output = -1;
  for (const schematic::OpAmp& one : netlist.opamps) {
    const schematic::OpAmpModel& model = netlist.model_of(one);
    if (one.out == circuit.output) output = static_cast<int>(opamps.size());
    opamps.push_back({.plus = node(one.plus),
                      .minus = node(one.minus),
                      .out = node(one.out),
                      .gain_bandwidth = model.is_ideal ? Hertz{0.0} : model.gain_bandwidth,
                      .noise_per_hz = std::pow(model.voltage_noise_v_per_rthz, 2)});
  }
  if (output < 0) throw DesignError(fmt::format("no op-amp drives the output {}", circuit.output));
  if (!netlist.multipliers.empty() || !netlist.sources.empty() || !netlist.expressions.empty())
    throw DesignError(
        "the circuit has sources or multipliers, expected capacitors, switches and op-amps alone");
  for (const schematic::Part& one : netlist.parts) {
    if (one.kind != schematic::Part::Kind::capacitor)
      throw DesignError(
          fmt::format("{} is no capacitor, expected capacitors, switches and op-amps alone", one.name));
    const int from = node(one.from);
    capacitors.push_back({from, node(one.to), one.realised});
  }
  for (const schematic::Contact& one : netlist.contacts) {
    const auto by = std::ranges::find(circuit.phases, one.control, &SwitchedCircuit::Phase::node);
    if (by == circuit.phases.end()) throw DesignError(fmt::format("{} is moved by no clock", one.name));
    const int from = node(one.from);
    switches.push_back({from, node(one.to), by->clock, by->phase});
  }
  nodes = static_cast<int>(numbers.size());
}

}  // namespace bodesmith::fpaa
