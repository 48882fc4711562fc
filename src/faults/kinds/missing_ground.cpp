#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "faults/circuit_board.hpp"

namespace bodesmith::faults {
namespace {

/// What an op-amp's equation leaves out.
constexpr double kFloatingModelError = 0.02;
/// A floating input follows what it is next to through stray capacitances: V+ = k V of the other input (t = ln(1 - k):
/// the op-amp loses its gain), of its own output or of its stage's input (t = ln k).
constexpr double kFollowsMost = 1e-8;
constexpr double kFollowsLeast = 0.9;
constexpr double kPicksUpLeast = 1e-5;

class MissingGround : public FaultKind {
 public:
  MissingGround()
      : FaultKind("missing_ground", "a non-inverting input that is not connected to ground", 0.06) {}

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    const auto& opamps = board.circuit().opamps;
    for (std::size_t i = 0; i < opamps.size(); ++i) {
      if (opamps[i].plus != "0") continue;
      Fault follows_minus = start(opamps[i].name, kFollowsMost, kFollowsLeast);
      follows_minus.effect = [&board, i](double t) { return roughly(board.inputs_follow(i, std::exp(t))); };
      out.push_back(std::move(follows_minus));
      for (const std::string& node : near_nodes(board.circuit(), opamps[i])) {
        Fault pickup = start(opamps[i].name, kPicksUpLeast, 1.0);
        pickup.effect = [&board, i, node](double t) {
          Effect effect;
          effect.stamps = {board.plus_follows(i, node, std::exp(t))};
          return roughly(std::move(effect));
        };
        out.push_back(std::move(pickup));
      }
    }
    return out;
  }

 private:
  /// Its output, and what drives its stage: the input or another stage's op-amp.
  static std::vector<std::string> near_nodes(const schematic::Netlist& circuit,
                                             const schematic::OpAmp& opamp) {
    std::vector<std::string> out = {opamp.out};
    for (const schematic::Part& part : circuit.parts) {
      for (const std::string& node : {part.from, part.to}) {
        const bool drives = node == "in" || std::ranges::any_of(circuit.opamps, [&](const auto& other) {
                              return other.out == node && other.group != opamp.group;
                            });
        if (part.group == opamp.group && drives && std::ranges::find(out, node) == out.end())
          out.push_back(node);
      }
    }
    return out;
  }

  static Fault start(const std::string& name, double from, double to) {
    Fault out = Fault::of(name, from, to);
    out.words = [name](double) {
      return fmt::format("the non-inverting input of {} is not connected to ground", name);
    };
    out.rework = fmt::format("connect the non-inverting input of {} to ground", name);
    return out;
  }

  static Effect roughly(Effect effect) {
    effect.model_error = kFloatingModelError;
    for (Stamp& stamp : effect.stamps) stamp.rough = true;
    return effect;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, missing_ground_fault, MissingGround)

}  // namespace bodesmith::faults
