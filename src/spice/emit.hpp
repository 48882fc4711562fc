#pragma once

#include <string>

#include "base/files.hpp"
#include "circuit/circuit.hpp"
#include "circuit/realise.hpp"
#include "multiplier_layout/layout.hpp"
#include "spice/deck_tolerances.hpp"

namespace bodesmith {

/// The portable library: `.subckt compensator in out`, one subcircuit a stage, the op-amp macromodel; plain
/// numbers, products instead of powers, E/G sources with VALUE={…} only, so that ngspice, LTspice and Xyce
/// read the same.
std::string compensator_library(const Circuit& circuit, const std::string& title);
/// The same for LTspice's Monte Carlo: values as {mc(value,tolerance)} of the parameters resistor_tolerance
/// and capacitor_tolerance.
std::string compensator_library_with_tolerances(const Circuit& circuit, const std::string& title);

/// Every file of `spice -o DIR` but circuit.json: compensator.sub, parts.csv; for ngspice ac.cir,
/// transient.cir, noise.cir, monte_carlo_ngspice.cir; ltspice_ac.cir, ltspice_monte_carlo.cir with
/// compensator_mc.sub; xyce_ac.cir.
void add_spice_files(const Realised& realised, const std::string& title, OutputSet& out,
                     const DeckTolerances& tolerances = {});

/// `part,section,series,wanted_ohm,realised_ohm,wanted_f,realised_f` (contract). A cell that does not apply
/// is empty.
std::string parts_csv(const Circuit& circuit);

/// `.subckt disturbance x branch out` and `.subckt slope_detector x branch`.
std::string disturbance_library(const DisturbanceLayout& layout, const std::string& title);

}  // namespace bodesmith
