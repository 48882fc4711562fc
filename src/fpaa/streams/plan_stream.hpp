#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "fpaa/device/memory_image.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/streams/board_networks.hpp"

namespace bodesmith::fpaa::an231 {

/// I/O cells of a plan's pins: "chip1.out1" -> 3 (IO3).
using PinCells = std::map<std::string, int>;

/// The complete configuration of a plan's chips.
struct PlanStreams {
  struct Chip {
    int chip = 1;
    MemoryImage memory;
  };
  std::vector<Chip> chips;
  PinCells cells;
  std::vector<std::string> warnings;  ///< what has no precedent in public streams, what to mind

  /// Of one chip: "in1" -> "IO1".
  std::map<std::string, std::string> pins_of(int chip) const;
};
/// Places, routes and writes a plan, without any vendor program: op-amps, capacitors, clocks, I/O cells (`wanted`: those that the user
/// chose) and lines. Refused, in one line, where the plan has a CAM whose switches are not publicly known, a CAB is too small, lines do not
/// suffice, or one of the vendor's rules is broken (a half-period output at a static branch, read in the wrong phase, or by another clock).
Outcome<PlanStreams> plan_streams(const Plan& plan, const PinCells& wanted = {});

/// What these streams make, read back from their bytes: the chips' circuits, wired outside as the plan says.
BoardCircuit read_back(const Plan& plan, const PlanStreams& streams);
/// Wires a board's chips outside as the plan does.
void add_links(BoardCircuit& board, const Plan& plan, const PinCells& cells);

/// The cell of a plan's pin; nothing where it is on none.
std::optional<BoardPin> board_pin(const PinCells& cells, const std::string& pin);
/// Those at the plan's first input pin that is wired to nothing, and at its output pin.
std::optional<SignalPins> end_pins(const Plan& plan, const PinCells& cells);

}  // namespace bodesmith::fpaa::an231
