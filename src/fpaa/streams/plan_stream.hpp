#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/streams/board_networks.hpp"
#include "fpaa/streams/chip_layout.hpp"

namespace bodesmith::fpaa::an231 {

struct PlanStreamOptions {
  std::map<std::string, int> cells;  ///< "chip1.out1" -> 3: I/O cells that the user chose
};

/// The complete configuration of a plan's chips.
struct PlanStreams {
  struct Chip {
    int chip = 1;
    BuiltChip built;
  };
  std::vector<Chip> chips;
  std::vector<std::string> warnings;  ///< what has no precedent in public streams, what to mind
};

/// Places, routes and writes a plan, without any vendor program. Refused where the plan has a CAM whose
/// switches are not publicly known, where it does not fit, or breaks one of the vendor's rules.
Outcome<PlanStreams> plan_streams(const Plan& plan, const PlanStreamOptions& options = {});

/// What these streams make, read back from their bytes: the chips' circuits, wired outside as the plan says.
BoardCircuit read_back(const Plan& plan, const PlanStreams& streams);
/// The same for any chips with these pins (plan's chip number -> pin -> I/O cell).
std::vector<PinLink> pin_links(const Plan& plan, const std::vector<ChipCircuit>& chips,
                               const std::map<int, std::map<std::string, int>>& pins);

/// The plan's first input pin that is wired to nothing, and its output pin: ("chip1.in1", "chip2.out1").
struct EndPins {
  std::string input;
  std::string output;
};
Outcome<EndPins> end_pins(const Plan& plan);

}  // namespace bodesmith::fpaa::an231
