#pragma once

#include <string>

#include "circuit/circuit.hpp"

namespace bodesmith {

/// A number as every simulator reads it: exponents, never suffixes (1M is 1e-3 in SPICE).
std::string spice_number(double value);

/// The op-amp macromodel `bodesmith_opamp p n o`; an ideal one for a model named "ideal".
std::string opamp_library(const OpAmpModel& model);

/// "-1.88 (s + 107.6)/(s + 126.4)" for comments.
std::string transfer_text(const std::vector<Biquad>& factors);

}  // namespace bodesmith
