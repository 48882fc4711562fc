#include <fmt/format.h>

#include "faults/kinds/part_words.hpp"

namespace bodesmith::faults {
namespace {

constexpr double kSolderBridge_S = 100.0;  ///< 10 mohm

class ShortedPart : public FaultKind {
 public:
  std::string_view name() const override { return "short"; }
  std::string_view what() const override { return "a part that is bridged"; }
  double prior() const override { return 0.10; }

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    for (std::size_t i = 0; i < board.circuit().parts.size(); ++i) {
      const schematic::Part& part = board.circuit().parts[i];
      Fault fault = fault_of_part(board, i);
      fault.effect = [&board, i](double) { return board.replaced(i, kSolderBridge_S); };
      fault.words = [part](double) {
        return fmt::format("{} ({}) is shorted", part.name, value_text(part, part.realised));
      };
      fault.rework =
          fmt::format("look for a solder bridge across {}; if there is none, {}", part.name, fault.rework);
      out.push_back(std::move(fault));
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, shorted_part_fault, ShortedPart)

}  // namespace bodesmith::faults
