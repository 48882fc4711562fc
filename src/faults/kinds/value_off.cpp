#include <fmt/format.h>

#include <cmath>

#include "faults/kinds/part_words.hpp"

namespace bodesmith::faults {
namespace {

/// A fault begins at this many tolerances and ends at a factor of 30; t = ln |ln(value/nominal)|, so that 5 % and a
/// factor of 5 are as likely.
constexpr double kLeastTolerances = 3.0;
constexpr double kLargestFactor = 30.0;

class ValueOff : public FaultKind {
 public:
  std::string_view name() const override { return "value_off"; }
  std::string_view what() const override { return "a part of another value"; }
  double prior() const override { return 0.30; }

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    for (std::size_t i = 0; i < board.circuit().parts.size(); ++i) {
      for (const double sign : {1.0, -1.0}) {
        const schematic::Part& part = board.circuit().parts[i];
        Fault fault = fault_of_part(board, i);
        fault.from = std::log(kLeastTolerances * board.tolerance(i));
        fault.to = std::log(std::log(kLargestFactor));
        fault.effect = [&board, i, sign](double t) { return board.changed(i, std::exp(sign * std::exp(t))); };
        fault.words = [part, sign](double t) {
          return fmt::format("{} is {} instead of {}", part.name,
                             value_text(part, part.realised * std::exp(sign * std::exp(t))),
                             value_text(part, part.realised));
        };
        fault.size = [part, sign](double t) {
          return FaultSize{value_key(part), part.realised * std::exp(sign * std::exp(t))};
        };
        out.push_back(std::move(fault));
      }
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, value_off_fault, ValueOff)

}  // namespace bodesmith::faults
