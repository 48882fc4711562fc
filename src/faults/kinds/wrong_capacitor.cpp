#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "faults/plan_board.hpp"

namespace bodesmith::faults {
namespace {

/// t = ln |ln(units/planned)|, as of the parts of a circuit; mismatch is far smaller than the least change.
constexpr double kLeastChange = 0.01;
constexpr double kMostUnits = 510.0;  ///< two banks
constexpr double kLeastUnits = 0.5;

class WrongCapacitor : public FaultKind {
 public:
  WrongCapacitor() : FaultKind("wrong_capacitor", "a capacitor of a CAM with another number of units", 0.6) {}

  std::vector<Fault> on_plan(const PlanBoard& board) const override {
    std::vector<Fault> out;
    for (std::size_t i = 0; i < board.units().size(); ++i) {
      const double units = board.units()[i];
      if (!(units > 0.0)) continue;
      for (const double sign : {1.0, -1.0}) {
        const double most = sign > 0.0 ? std::log(kMostUnits / units) : std::log(units / kLeastUnits);
        const double least = std::max(kLeastChange, 0.7 / units);
        if (!(most > least)) continue;
        Fault fault = start(board, i);
        fault.from = std::log(least);
        fault.to = std::log(most);
        const auto wrong = [units, sign](double t) { return units * std::exp(sign * std::exp(t)); };
        fault.effect = [i, wrong](double t) {
          Effect effect;
          effect.units = {{i, wrong(t)}};
          return effect;
        };
        fault.words = [name = board.capacitors()[i], units, wrong](double t) {
          return fmt::format("{} has {} units instead of {}", name, rounded_text(wrong(t), 3), units);
        };
        fault.size = [wrong](double t) { return FaultSize{"value_units", wrong(t)}; };
        out.push_back(std::move(fault));
      }
      Fault missing = start(board, i);
      missing.effect = [i](double) {
        Effect effect;
        effect.units = {{i, 1e-6}};
        return effect;
      };
      missing.words = [name = board.capacitors()[i]](double) {
        return fmt::format("{} has no units at all", name);
      };
      out.push_back(std::move(missing));
    }
    return out;
  }

 private:
  static Fault start(const PlanBoard& board, std::size_t i) {
    Fault out = Fault::of(board.capacitors()[i]);
    out.rework = fmt::format("write {} to {} again", board.units()[i], board.capacitors()[i]);
    out.replaces = {i};
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, wrong_capacitor_fault, WrongCapacitor)

}  // namespace bodesmith::faults
