#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "faults/circuit_board.hpp"

namespace bodesmith::faults {
namespace {

/// How an op-amp takes a load is known no better than the op-amp itself.
constexpr double kCableModelError = 0.02;
/// t = ln C: from more than a stray capacitance to a metre-long cable and far beyond.
constexpr double kLeast_F = 10e-12;
constexpr double kMost_F = 1e-6;

class CapacitiveLoad : public FaultKind {
 public:
  std::string_view name() const override { return "capacitive_load"; }
  std::string_view what() const override {
    return "a cable or probe whose capacitance loads the output or a node";
  }
  double prior() const override { return 0.06; }

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    for (const std::string& node : board.nodes()) {
      const std::string where = node == "out" ? "the output" : "node " + node;
      Fault fault;
      fault.parts = {where};
      fault.site = where;
      fault.from = std::log(kLeast_F);
      fault.to = std::log(kMost_F);
      fault.effect = [&board, node](double t) {
        Effect effect;
        effect.model_error = kCableModelError;
        effect.stamps = {board.admittance(node, "0", 0.0, std::exp(t))};
        return effect;
      };
      fault.words = [where](double t) {
        return fmt::format("{} is loaded with {} to ground (a cable or probe)", where,
                           engineering_text(std::exp(t), "F"));
      };
      fault.size = [](double t) { return FaultSize{"value_f", std::exp(t)}; };
      fault.rework = fmt::format("take what is connected to {} away, or put a buffer before it", where);
      out.push_back(std::move(fault));
    }
    return out;
  }
};

}  // namespace

const FaultKind& capacitive_load_fault() {
  static const CapacitiveLoad kind;
  return kind;
}

}  // namespace bodesmith::faults
