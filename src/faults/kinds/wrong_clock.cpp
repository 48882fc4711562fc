#include <fmt/format.h>

#include <map>
#include <set>

#include "base/text.hpp"
#include "faults/plan_board.hpp"

namespace bodesmith::faults {
namespace {

/// Divisors that are mistaken for one another, besides the chip's other clocks.
constexpr double kFactors[] = {2.0, 0.5, 4.0, 0.25};

class WrongClock : public FaultKind {
 public:
  WrongClock()
      : FaultKind("wrong_clock", "a CAM on another clock, or a clock of a chip with another divisor", 0.25) {}

  std::vector<Fault> on_plan(const PlanBoard& board) const override {
    const auto& nodes = board.graph().nodes;
    std::map<std::pair<int, double>, std::vector<std::size_t>> by_clock;
    for (std::size_t n = 0; n < nodes.size(); ++n)
      by_clock[{nodes[n].chip, nodes[n].cam->clock_a.value}].push_back(n);
    std::vector<Fault> out;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const double hz = nodes[n].cam->clock_a.value;
      std::set<double> factors(std::begin(kFactors), std::end(kFactors));
      for (const auto& [clock, members] : by_clock) {
        if (clock.first == nodes[n].chip && clock.second != hz) factors.insert(clock.second / hz);
      }
      for (const double factor : factors) add(board, {n}, nodes[n].name, hz, factor, out);
    }
    for (const auto& [clock, members] : by_clock) {
      if (members.size() < 2) continue;
      const std::string name =
          fmt::format("chip{} clock {}", clock.first, engineering_text(clock.second, "Hz", 4));
      for (const double factor : kFactors) add(board, members, name, clock.second, factor, out);
    }
    return out;
  }

 private:
  static void add(const PlanBoard& board, const std::vector<std::size_t>& cams, const std::string& name,
                  double hz, double factor, std::vector<Fault>& out) {
    Effect effect;
    for (const std::size_t cam : cams) effect.clocks.emplace_back(cam, factor);
    if (!board.can_run(effect)) return;
    Fault fault = Fault::of(name);
    fault.effect = [effect](double) { return effect; };
    fault.words = [name, hz, factor](double) {
      return fmt::format("{} runs at {} instead of {}", name, engineering_text(hz * factor, "Hz", 4),
                         engineering_text(hz, "Hz", 4));
    };
    fault.size = [hz, factor](double) { return FaultSize{"clock_hz", hz * factor}; };
    fault.rework = fmt::format("set the clock of {} to {}", name, engineering_text(hz, "Hz", 4));
    out.push_back(std::move(fault));
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, wrong_clock_fault, WrongClock)

}  // namespace bodesmith::faults
