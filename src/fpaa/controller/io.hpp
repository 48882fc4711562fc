#pragma once

#include <map>
#include <optional>
#include <string>

#include "fpaa/controller/controller.hpp"

namespace bodesmith::fpaa {

/// Throws DesignError with what keeps a placed variant from its board: I/O cells, ClockBs and clocks of each chip. Fills in the I/O cells
/// used.
void check_controller_io(ControllerVariant& variant);
/// The variant as a plan: chips, clocks, CAMs with their capacitors, every wire. For picture, build sheet and
/// streams.
Plan controller_plan(const ControllerVariant& variant);
/// Pins of that plan and the signals at them: "chip1.in2" -> "x2". Pins between chips are left out.
std::map<std::string, std::string> pin_signals(const ControllerVariant& variant);

}  // namespace bodesmith::fpaa
