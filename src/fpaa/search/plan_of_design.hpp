#pragma once

#include "base/error.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/search/design.hpp"

namespace bodesmith::fpaa {

/// A finished design (whole capacitors) as CAMs on chips with clocks, places, wires and pins; without errors,
/// notes and headroom. A stage goes to the chip of what it reads if there is room (op-amps and capacitors in
/// one CAB, at most six clocks of one system divisor, seven pins a chip), else to the next that has it. Refused
/// when the board is too small.
Outcome<Plan> plan_of_design(const Design& design, const Board& board);

}  // namespace bodesmith::fpaa
