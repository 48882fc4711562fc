#pragma once

#include <string>

#include "base/files.hpp"
#include "circuit/circuit.hpp"
#include "circuit/realise.hpp"
#include "circuit/parts/tolerances.hpp"
#include "multiplier_layout/layout.hpp"

namespace bodesmith::spice {

/// The portable library: `.subckt compensator in out`, one subcircuit a stage, the op-amp macromodel; plain
/// numbers, products instead of powers, E/G sources with VALUE={…} only, so that ngspice, LTspice and Xyce
/// read the same.
std::string compensator_library(const circuit::Circuit& circuit, const std::string& title);
/// The same for LTspice's Monte Carlo: values as {mc(value,tolerance)} of the parameters resistor_tolerance
/// and capacitor_tolerance.
std::string compensator_library_with_tolerances(const circuit::Circuit& circuit, const std::string& title);

/// What the Monte Carlo decks run.
struct MonteCarloOptions {
  circuit::Tolerances tolerances;
  int runs = 100;
  unsigned seed = 1;
};

/// Every file of `spice -o DIR` but circuit.json: compensator.sub, parts.csv; for ngspice ac.cir,
/// transient.cir, noise.cir, monte_carlo_ngspice.cir; ltspice_ac.cir, ltspice_monte_carlo.cir with
/// compensator_mc.sub; xyce_ac.cir.
void add_spice_files(const circuit::Realised& realised, const std::string& title, OutputSet& out,
                     const MonteCarloOptions& monte_carlo = {});

/// `.subckt disturbance x branch out` and `.subckt slope_detector x branch`.
std::string disturbance_library(const multiplier_layout::Layout& layout, const std::string& title);

}  // namespace bodesmith::spice
