#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "fpaa/cams/switches.hpp"
#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// Time in a plan is counted in half periods of the master clock: then every clock's period and every half
/// cycle is a whole number, whatever the divisors.
double ticks_per_second(const Board& board);

/// A plan's wires, resolved: CAMs with what feeds them. Pins that are wired on pass their signal unchanged.
struct PlanGraph {
  /// What comes out of something: the board's input, or a CAM (index into `nodes`).
  struct Source {
    std::optional<std::size_t> node;  ///< nothing: the input pin
  };
  struct Input {
    std::size_t number = 1;  ///< of the CAM's inputs, from 1
    Source from;
  };
  struct PlanNode {
    const PlacedCam* cam = nullptr;
    std::string name;  ///< "chip1.Section1a"
    int chip = 1;
    std::int64_t period = 1;    ///< of its clock, in ticks
    std::int64_t delay = 0;     ///< delay_cycles, in ticks
    std::vector<Input> inputs;  ///< those that are wired; another one reads 0
  };
  std::vector<PlanNode> nodes;     ///< in the plan's order; they point into the plan
  std::vector<std::size_t> order;  ///< of the nodes: each after those it reads within the same instant
  bool looped = false;             ///< some CAM reads (late) what it makes itself
  Source output;                   ///< of the output pin that is wired to nothing
  double tick_rate = 32e6;         ///< ticks a second
};

/// The switches of a CAM as it is placed. Throws DesignError, by its name, where they are not known.
StageSwitches switches_of(const PlacedCam& cam, const std::string& name);

/// Refused: a wire from or to what is not there, two wires to one input, an input the CAM does not have, no wire to an output pin,
/// a loop without any delay.
Outcome<PlanGraph> plan_graph(const Plan& plan);

}  // namespace bodesmith::fpaa
