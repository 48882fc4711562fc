#pragma once

#include <functional>
#include <string>

#include "circuit/circuit.hpp"

namespace bodesmith::spice {

/// How a part's value is written.
using PartValue = std::function<std::string(const circuit::Part&)>;

/// The portable library: `.subckt compensator in out`, one subcircuit a stage, the op-amp macromodel; plain
/// numbers, products instead of powers, E/G sources with VALUE={…} only, so that ngspice, LTspice and Xyce
/// read the same.
std::string compensator_library(const circuit::Circuit& circuit, const std::string& title);
/// The same with the values in a dialect's own words.
std::string compensator_library(const circuit::Circuit& circuit, const std::string& title,
                                const PartValue& value);

}  // namespace bodesmith::spice
