#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fpaa/controller/controller.hpp"

namespace bodesmith::fpaa {

/// Signals that enter and leave each chip, by name, each through one I/O cell ("in1", "in2", … and "out1", …
/// in this order).
struct ChipSignals {
  std::vector<std::string> in;
  std::vector<std::string> out;
};
std::vector<ChipSignals> chip_signals(const ControllerVariant& variant);

/// I/O cells used, of each chip of the board.
std::vector<int> controller_io_cells(const ControllerVariant& variant);
/// No chip needs more I/O cells than it has.
std::optional<Refusal> check_controller_io(const ControllerVariant& variant);

/// ClockA and ClockB of every CAM of a chip, fastest first. ClockB is ClockA times the CAM's ratio.
std::vector<Hertz> chip_clocks(const ControllerVariant& variant, int chip);
/// Every ClockB is in the tree, and no chip needs more clocks than it has.
std::optional<Refusal> check_controller_clocks(const ControllerVariant& variant);

/// The variant as a plan: chips, clocks, CAMs with their capacitors, every wire. For picture, build sheet and
/// streams.
Plan controller_plan(const ControllerVariant& variant);
/// Pins of that plan and the signals at them: "chip1.in2" -> "x2". Pins between chips are left out.
std::map<std::string, std::string> pin_signals(const ControllerVariant& variant);

}  // namespace bodesmith::fpaa
