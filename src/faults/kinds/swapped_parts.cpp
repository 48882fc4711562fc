#include <fmt/format.h>

#include <cmath>

#include "faults/kinds/part_words.hpp"

namespace bodesmith::faults {
namespace {

/// Parts whose values differ by less than this many tolerances may be swapped without harm.
constexpr double kLeastDifference = 2.0;

/// Two parts of one sort in one stage, or in neighbouring ones.
bool are_neighbours(const schematic::Part& a, const schematic::Part& b) {
  return a.kind == b.kind && (a.group > b.group ? a.group - b.group : b.group - a.group) <= 1;
}

class SwappedParts : public FaultKind {
 public:
  SwappedParts() : FaultKind("swapped", "two neighbouring parts in each other's place", 0.10) {}

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    const auto& parts = board.circuit().parts;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      for (std::size_t j = i + 1; j < parts.size(); ++j) {
        const double ratio = parts[j].realised / parts[i].realised;
        if (!are_neighbours(parts[i], parts[j]) ||
            std::abs(std::log(ratio)) < kLeastDifference * board.tolerance(i))
          continue;
        Fault fault;
        fault.parts = {parts[i].name, parts[j].name};
        fault.site = parts[i].name + " and " + parts[j].name;
        fault.effect = [&board, i, j, ratio](double) {
          return joined(board.changed(i, ratio), board.changed(j, 1.0 / ratio));
        };
        fault.words = [a = parts[i], b = parts[j]](double) {
          return fmt::format("{} and {} are swapped ({} where {} belongs)", a.name, b.name,
                             value_text(b, b.realised), value_text(a, a.realised));
        };
        fault.rework = fmt::format("exchange {} and {}", parts[i].name, parts[j].name);
        fault.replaces = {i, j};
        out.push_back(std::move(fault));
      }
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, swapped_parts_fault, SwappedParts)

}  // namespace bodesmith::faults
