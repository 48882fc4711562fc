#pragma once

#include <complex>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "fpaa/device/circuit.hpp"
#include "fpaa/network/periodic_network.hpp"

namespace bodesmith::fpaa::an231 {

/// A pin of a chip, as a person names it.
struct BoardPin {
  int chip = 1;  ///< Address1
  int cell = 1;
  friend bool operator==(const BoardPin&, const BoardPin&) = default;
};

/// A wire outside the chips, from an output cell to an input cell, or from one input cell to another (both then
/// have the same signal).
struct PinLink {
  BoardPin from, to;
};

/// The chips of a board and what is wired between them.
struct BoardCircuit {
  Hertz master{16e6};
  std::vector<ChipCircuit> chips;
  std::vector<PinLink> links;

  /// Of the chip with this Address1.
  std::optional<std::size_t> index_of(int address1) const;
};

/// A node of one of the chips.
struct BoardNode {
  std::size_t chip = 0;
  CircuitNode node;
  friend bool operator==(const BoardNode&, const BoardNode&) = default;
};

/// What the bytes make between two pins: every op-amp on the way with its capacitors and switches as the memory has
/// them, op-amps that feed one another as one network, a sampling output cell as a follower behind a switch.
/// Nothing of a plan is in it. Throws DesignError where the output is none, or a switch is not understood.
PeriodicNetworks pin_networks(const BoardCircuit& board, BoardPin from, BoardPin to);

/// The one input and the one output that no wire joins. Refused, with the list, when there are more.
struct SignalPins {
  BoardPin input;
  BoardPin output;
};
Outcome<SignalPins> signal_pins(const BoardCircuit& board);

/// What a group of op-amps that feed each other makes of what it reads, as its capacitors and switches have
/// it: for one of its outputs, numerators (one a source) over a common denominator, in ascending powers of
/// 1/z; whole numbers in capacitor units where they stay exact. Sources count as held over a period.
struct StageTransfer {
  BoardNode opamp;
  int clock_divisor = 0;  ///< ACLK periods of a period; 0: nothing switches
  int phase = 1;          ///< in which the output is valid (1: from then on, unless it is reset)
  bool half_period = false;
  std::vector<BoardNode> inputs;
  std::vector<std::vector<double>> numerators;
  std::vector<double> denominator;
  std::string obstacle;  ///< why there is none
};

/// Of every op-amp that is on and has capacitors at its virtual ground.
std::vector<StageTransfer> stage_transfers(const BoardCircuit& board);

}  // namespace bodesmith::fpaa::an231
