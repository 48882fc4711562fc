#include <fmt/format.h>

#include "base/text.hpp"
#include "faults/kinds/part_words.hpp"

namespace bodesmith::faults {
namespace {

class WrongDecade : public FaultKind {
 public:
  std::string_view name() const override { return "wrong_decade"; }
  std::string_view what() const override {
    return "a part of ten or a hundred times the value, or a tenth or hundredth";
  }
  double prior() const override { return 0.12; }

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    for (std::size_t i = 0; i < board.circuit().parts.size(); ++i) {
      for (const double factor : {10.0, 0.1, 100.0, 0.01}) {
        const schematic::Part& part = board.circuit().parts[i];
        Fault fault = fault_of_part(board, i);
        fault.effect = [&board, i, factor](double) { return board.changed(i, factor); };
        fault.words = [part, factor](double) {
          return fmt::format("{} is {}, the wrong decade of {}", part.name,
                             value_text(part, part.realised * factor), value_text(part, part.realised));
        };
        fault.size = [part, factor](double) { return FaultSize{value_key(part), part.realised * factor}; };
        out.push_back(std::move(fault));
      }
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, wrong_decade_fault, WrongDecade)

}  // namespace bodesmith::faults
