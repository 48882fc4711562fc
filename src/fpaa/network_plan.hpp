#pragma once

#include "base/outcome.hpp"
#include "fpaa/network.hpp"
#include "fpaa/plan.hpp"

namespace bodesmith::fpaa {

/// A finished network (whole capacitors) as CAMs on chips with clocks, places, wires and pins; without errors,
/// notes and headroom. A stage goes to the chip of what it reads if there is room (op-amps and capacitors in
/// one CAB, at most six clocks and seven pins a chip), else to the first chip that has it. Refused when the
/// board is too small.
Outcome<Plan> plan_of_network(const Network& network, const Board& board);

}  // namespace bodesmith::fpaa
