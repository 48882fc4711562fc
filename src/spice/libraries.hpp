#pragma once

#include <optional>
#include <string>

#include "base/files.hpp"
#include "circuit/circuit.hpp"
#include "circuit/realise.hpp"
#include "multiplier_layout/budget.hpp"
#include "multiplier_layout/layout.hpp"
#include "schematic/writers/spice_library.hpp"
#include "spice/dialect.hpp"

namespace bodesmith::spice {

/// `.subckt compensator in out`, one subcircuit a stage.
schematic::SpiceLibrary compensator_library(const circuit::Circuit& circuit, const std::string& title);

/// Every file of `spice -o DIR` but circuit.json: compensator.sub, parts.csv, and the decks of every dialect
/// in dialect_registry().
void add_spice_files(const circuit::Realised& realised, const std::string& title, OutputSet& out,
                     const MonteCarloOptions& monte_carlo = {});

struct DisturbanceLibrary {
  /// With the amplitude gains: `.subckt disturbance_amplitude x branch amplitude out`.
  bool amplitude = false;
  /// Every multiplier off by these limits (for checks).
  std::optional<multiplier_layout::ErrorLimits> errors;
};

/// `.subckt disturbance x branch out`; more than two branches have their select lines after `branch`. Beside
/// it, when there is a switch, `.subckt slope_detector x branch`.
std::string disturbance_library(const multiplier_layout::Layout& layout, const std::string& title,
                                const DisturbanceLibrary& options = {});

/// `x branch out`, or with select lines and amplitude.
std::string disturbance_pins(const multiplier_layout::Layout& layout, bool amplitude);

}  // namespace bodesmith::spice
