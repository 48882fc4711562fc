#pragma once

#include <string>

#include "base/files.hpp"
#include "circuit/circuit.hpp"
#include "circuit/layout.hpp"
#include "circuit/realise.hpp"

namespace bodesmith {

/// The portable library: `.subckt compensator in out`, one subcircuit a stage, the op-amp macromodel; plain
/// numbers, products instead of powers, E/G sources with VALUE={…} only, so that ngspice, LTspice and Xyce
/// read the same.
std::string compensator_library(const Circuit& circuit, const std::string& title);

/// Every file of `spice -o DIR`: compensator.sub, ac.cir, transient.cir, parts.csv, circuit.json is the
/// caller's.
void add_spice_files(const Realised& realised, const std::string& title, OutputSet& out);

/// `part,section,series,wanted_ohm,realised_ohm,wanted_f,realised_f` (contract). A cell that does not apply
/// is empty.
std::string parts_csv(const Circuit& circuit);

/// `.subckt disturbance x branch out` and `.subckt slope_detector x branch`.
std::string disturbance_library(const DisturbanceLayout& layout, const std::string& title);

}  // namespace bodesmith
