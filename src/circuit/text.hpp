#pragma once

#include <string>
#include <vector>

#include "circuit/circuit.hpp"

namespace bodesmith::circuit {

/// "-1.88 (s + 107.6)/(s + 126.4)" for comments.
std::string transfer_text(const std::vector<Biquad>& factors);

/// `part,section,series,wanted_ohm,realised_ohm,wanted_f,realised_f` (contract). A cell that does not apply
/// is empty.
std::string parts_csv(const Circuit& circuit);

}  // namespace bodesmith::circuit
