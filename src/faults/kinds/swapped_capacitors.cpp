#include <fmt/format.h>

#include <cmath>

#include "faults/plan_board.hpp"

namespace bodesmith::faults {
namespace {

class SwappedCapacitors : public FaultKind {
 public:
  SwappedCapacitors()
      : FaultKind("swapped_capacitors", "two capacitors of one CAM in each other's place", 0.15) {}

  std::vector<Fault> on_plan(const PlanBoard& board) const override {
    std::vector<Fault> out;
    const std::vector<double>& units = board.units();
    for (std::size_t i = 0; i < units.size(); ++i) {
      for (std::size_t j = i + 1; j < units.size(); ++j) {
        if (board.cam_of(i) != board.cam_of(j) || std::abs(units[i] - units[j]) < 0.5) continue;
        Fault fault;
        fault.parts = {board.capacitors()[i], board.capacitors()[j]};
        fault.site = fault.parts[0] + " and " + fault.parts[1];
        fault.effect = [i, j, a = units[i], b = units[j]](double) {
          Effect effect;
          effect.units = {{i, std::max(b, 1e-6)}, {j, std::max(a, 1e-6)}};
          return effect;
        };
        fault.words = [parts = fault.parts, a = units[i], b = units[j]](double) {
          return fmt::format("{} and {} are swapped ({} and {} units)", parts[0], parts[1], b, a);
        };
        fault.rework = fmt::format("exchange {} and {}", fault.parts[0], fault.parts[1]);
        fault.replaces = {i, j};
        out.push_back(std::move(fault));
      }
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, swapped_capacitors_fault, SwappedCapacitors)

}  // namespace bodesmith::faults
