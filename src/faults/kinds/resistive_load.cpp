#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "faults/circuit_board.hpp"

namespace bodesmith::faults {
namespace {

/// How an op-amp takes a load is known no better than the op-amp itself.
constexpr double kLoadModelError = 0.02;
/// t = ln R: from little more than a solder bridge to a leak.
constexpr double kLeast_Ohm = 1.0;
constexpr double kMost_Ohm = 100e6;

class ResistiveLoad : public FaultKind {
 public:
  std::string_view name() const override { return "resistive_load"; }
  std::string_view what() const override {
    return "a resistance from the output or a node to ground: a terminated cable, a probe, a solder bridge";
  }
  double prior() const override { return 0.06; }

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    for (const std::string& node : board.nodes()) {
      const std::string where = node == "out" ? "the output" : "node " + node;
      Fault fault;
      fault.parts = {where};
      fault.site = where;
      fault.from = std::log(kLeast_Ohm);
      fault.to = std::log(kMost_Ohm);
      fault.effect = [&board, node](double t) {
        Effect effect;
        effect.model_error = kLoadModelError;
        effect.stamps = {board.admittance(node, "0", std::exp(-t), 0.0)};
        return effect;
      };
      fault.words = [where](double t) {
        return fmt::format("{} is loaded with {} to ground", where, engineering_text(std::exp(t), "Ω"));
      };
      fault.size = [](double t) { return FaultSize{"value_ohm", std::exp(t)}; };
      fault.rework = fmt::format(
          "take what loads {} away (cable, probe, solder bridge), or put a buffer before it", where);
      out.push_back(std::move(fault));
    }
    return out;
  }
};

}  // namespace

const FaultKind& resistive_load_fault() {
  static const ResistiveLoad kind;
  return kind;
}

}  // namespace bodesmith::faults
