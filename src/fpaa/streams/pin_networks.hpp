#pragma once

#include "base/outcome.hpp"
#include "fpaa/network/periodic_network.hpp"
#include "fpaa/streams/charge_system.hpp"

namespace bodesmith::fpaa::an231 {

/// A pin of a chip, as a person names it.
struct BoardPin {
  int chip = 1;  ///< Address1
  int cell = 1;
};

/// What the bytes make between two pins: every op-amp on the way with its capacitors and switches as the memory has
/// them, op-amps that feed one another as one network, a sampling output cell as a follower behind a switch.
/// Nothing of a plan is in it. Refused where the output is none, or a switch is not understood.
Outcome<PeriodicNetworks> pin_networks(const BoardCircuit& board, BoardPin from, BoardPin to);

/// The one input and the one output that no wire joins. Refused, with the list, when there are more.
struct SignalPins {
  BoardPin input;
  BoardPin output;
};
Outcome<SignalPins> signal_pins(const BoardCircuit& board);

}  // namespace bodesmith::fpaa::an231
