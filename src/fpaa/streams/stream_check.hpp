#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fpaa/plan/plan.hpp"
#include "fpaa/streams/board_networks.hpp"
#include "fpaa/streams/netlist.hpp"
#include "fpaa/streams/plan_stream.hpp"

namespace bodesmith::fpaa::an231 {

/// What the bytes make between two pins, as their switches move, against what is wanted. Throws DesignError where they
/// make nothing that is understood.
using WantedResponse = std::function<Complex(RadPerSecond)>;
PlanError stream_error(const BoardCircuit& board, const SignalPins& pins, Band band,
                       const WantedResponse& wanted);

/// The I/O cells that a plan with a stream names for its pins.
PinCells plan_cells(const Plan& plan);

/// Byte by byte: a chip's memory against the stream that the plan itself makes (with the plan's own pins), one
/// line a byte ("chip 1 bank 3 byte 5: 08, the plan has 0C (C3 of CAB 1)"). Refused when the plan makes none.
Outcome<std::vector<std::string>> memory_differences(const Plan& plan, const std::vector<ChipImage>& chips);

/// What stands at an address, for messages: "C3 of CAB 1", "divisor of Clock 0", …
std::string address_text(Address at);

}  // namespace bodesmith::fpaa::an231
