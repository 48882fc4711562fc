#pragma once

#include <string>

#include "circuit/opamp.hpp"

namespace bodesmith::spice {

/// The op-amp macromodel `.subckt bodesmith_opamp p n o` (or another name): two poles, slew rate, swing, output resistance and
/// noise by resistors and diodes only, so that every simulator has it; two lines for an ideal model.
std::string opamp_macromodel(const circuit::OpAmpModel& model,
                             const std::string& subcircuit = "bodesmith_opamp");

}  // namespace bodesmith::spice
