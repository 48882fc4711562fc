#pragma once

#include "base/outcome.hpp"
#include "fpaa/an231/transfers.hpp"
#include "fpaa/plan.hpp"

namespace bodesmith::fpaa::an231 {

struct BoardPin {
  int chip = 1;  ///< Address1
  int cell = 1;
};

/// What the bytes make between two pins, as a plan: one CAM an op-amp ("chip1.CAB2op1") with the z transfer of
/// its capacitors and its clock, and the wires between them. So the functions for plans answer what the board
/// does as it runs, with all clocks and holds. Refused with the reason where there is no z transfer.
Outcome<Plan> decoded_plan(const BoardCircuit& board, BoardPin from, BoardPin to);

/// The pins of a board that nothing outside is wired to: its only input and its only output. Refused with what
/// there is when there are more, or none.
struct SignalPins {
  BoardPin input;
  BoardPin output;
};
Outcome<SignalPins> signal_pins(const BoardCircuit& board);

}  // namespace bodesmith::fpaa::an231
