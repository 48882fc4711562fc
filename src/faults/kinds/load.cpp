#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "faults/circuit_board.hpp"

namespace bodesmith::faults {
namespace {

/// A load between a node and ground whose size, ohms or farads, is exp(t).
struct Load {
  double least = 0.0;  ///< exp(t) lies between these beforehand
  double most = 0.0;
  bool resistive = false;
  std::string_view words_end;
  std::string_view rework;  ///< what to do about it; {} is "the output" or "node n1"

  Stamp stamp(const CircuitBoard& board, const std::string& node, double value) const {
    return board.admittance(node, "0", resistive ? 1.0 / value : 0.0, resistive ? 0.0 : value);
  }
};

/// How an op-amp takes a load at its output is known no better than the op-amp itself; between passive parts a load is one
/// more of them.
constexpr double kLoadModelError = 0.02;

bool is_driven(const CircuitBoard& board, const std::string& node) {
  const auto& opamps = board.circuit().opamps;
  return std::ranges::any_of(opamps, [&](const schematic::OpAmp& one) { return one.out == node; });
}

/// One at every node of the board, the output among them.
std::vector<Fault> load_faults(const CircuitBoard& board, const Load& load) {
  std::vector<Fault> out;
  for (const std::string& node : board.nodes()) {
    const std::string where = node == "out" ? "the output" : "node " + node;
    Fault fault = Fault::of(where, load.least, load.most);
    fault.effect = [&board, node, load, driven = is_driven(board, node)](double t) {
      Effect effect;
      effect.stamps = {load.stamp(board, node, std::exp(t))};
      if (driven) {
        effect.model_error = kLoadModelError;
        effect.stamps[0].rough = true;
      }
      return effect;
    };
    fault.words = [where, load](double t) {
      return fmt::format("{} is loaded with {} to ground{}", where,
                         engineering_text(std::exp(t), load.resistive ? "Ω" : "F"), load.words_end);
    };
    fault.size = [load](double t) {
      return FaultSize{load.resistive ? "value_ohm" : "value_f", std::exp(t)};
    };
    fault.rework = fmt::format(fmt::runtime(load.rework), where);
    out.push_back(std::move(fault));
  }
  return out;
}

/// t = ln C: from more than a stray capacitance to a metre-long cable and far beyond.
struct CapacitiveLoad : FaultKind {
  CapacitiveLoad()
      : FaultKind("capacitive_load", "a cable or probe whose capacitance loads the output or a node", 0.06) {}
  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    return load_faults(board, {10e-12, 1e-6, false, " (a cable or probe)",
                               "take what is connected to {} away, or put a buffer before it"});
  }
};

/// t = ln R: from little more than a solder bridge to a leak.
struct ResistiveLoad : FaultKind {
  ResistiveLoad()
      : FaultKind(
            "resistive_load",
            "a resistance from the output or a node to ground: a terminated cable, a probe, a solder bridge",
            0.06) {}
  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    return load_faults(board,
                       {1.0, 100e6, true, "",
                        "take what loads {} away (cable, probe, solder bridge), or put a buffer before it"});
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, capacitive_load_fault, CapacitiveLoad)
BODESMITH_ENTRY(FaultKind, resistive_load_fault, ResistiveLoad)

}  // namespace bodesmith::faults
