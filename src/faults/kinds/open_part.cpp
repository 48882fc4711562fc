#include <fmt/format.h>

#include "faults/kinds/part_words.hpp"

namespace bodesmith::faults {
namespace {

class OpenPart : public FaultKind {
 public:
  std::string_view name() const override { return "open"; }
  std::string_view what() const override { return "a part that is missing, broken or not soldered"; }
  double prior() const override { return 0.12; }

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    for (std::size_t i = 0; i < board.circuit().parts.size(); ++i) {
      const schematic::Part& part = board.circuit().parts[i];
      Fault fault = fault_of_part(board, i);
      // What is left is a leak of a teraohm: a node that only this part fed stays defined.
      fault.effect = [&board, i](double) { return board.replaced(i, 1e-12); };
      fault.words = [part](double) {
        return fmt::format("{} ({}) is open: missing, broken or not soldered", part.name,
                           value_text(part, part.realised));
      };
      out.push_back(std::move(fault));
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, open_part_fault, OpenPart)

}  // namespace bodesmith::faults
