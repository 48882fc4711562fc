#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fpaa/device/cells.hpp"

namespace bodesmith::fpaa::an231 {

/// A pin with what it has to reach (input) or come from (output).
struct PinNeed {
  std::string name;
  bool is_input = true;
  std::vector<int> cabs;  ///< CABs that read an input
  int cab = 0;            ///< of the op-amp that drives an output
  int opamp = 0;
  bool sampled = false;  ///< needs a sampling output cell: IO1 to IO4
  std::optional<int> wanted_cell;
};

/// Pins on I/O cells, and their lines.
struct RoutedPins {
  std::map<std::string, int> cells;
  struct CellNibble {
    int cell;
    Column column;
    int nibble;
  };
  std::vector<CellNibble> nibbles;
  std::array<int, kCabs> line_drivers{};                      ///< bytes
  std::array<std::array<int, kLines>, kCabs> local_inputs{};  ///< line that each local input takes
  std::map<std::pair<std::string, int>, int> selectors;       ///< (input pin, CAB) -> near selector
};

/// The first choice of cells, in the order of preference (inputs from IO1 on, outputs from IO3 on), whose lines
/// suffice; nothing when none does.
std::optional<RoutedPins> route_pins(const std::vector<PinNeed>& pins);

}  // namespace bodesmith::fpaa::an231
