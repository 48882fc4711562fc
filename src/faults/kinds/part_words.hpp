#pragma once

#include <string>

#include "faults/circuit_board.hpp"

namespace bodesmith::faults {

/// "12.1 kΩ", "10 nF".
std::string value_text(const schematic::Part& part, double value);
/// "value_ohm" or "value_f".
std::string value_key(const schematic::Part& part);
/// A fault of one part that is mended by a new one of its nominal value.
Fault fault_of_part(const CircuitBoard& board, std::size_t part);

}  // namespace bodesmith::faults
