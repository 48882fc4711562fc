#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "base/provenance.hpp"
#include "cli/command_line.hpp"
#include "fpaa/device/mismatch.hpp"
#include "fpaa/network/settling.hpp"
#include "lti/sections.hpp"
#include "simulate/references.hpp"
#include "synthesis/realise_search.hpp"

namespace bodesmith::cli {

/// --realization, --series and --capacitor-series, which `spice` and `yield` share.
void add_circuit_options(CommandLine& line);
/// A circuit with exact resistors has exact capacitors unless --capacitor-series says otherwise.
synthesis::RealiseOptions read_circuit_options(const CommandLine& line);

/// --stock, limits of the values, --isolation-ohm, --opamp, --opamp-library.
void add_parts_options(CommandLine& line);
/// Those and add_circuit_options' together.
synthesis::RealiseOptions read_parts_options(const CommandLine& line, Provenance& from);
/// --resistor-percent and --capacitor-percent; `otherwise`: of what says nothing of them.
void add_tolerance_options(CommandLine& line, schematic::Tolerances otherwise = {});
/// `otherwise`: the circuit's own.
schematic::Tolerances read_tolerances(const CommandLine& line, schematic::Tolerances otherwise);

/// The realisation asked for, or (none asked for) the first that is worth building.
synthesis::BuildChoice design_circuit(const CommandLine& line, const Sections& sections,
                                      const synthesis::RealiseOptions& options, Provenance& from,
                                      double amplitude_v = 1.0);

/// Adds --check.
void add_check_option(CommandLine& line, const std::string& what);
/// Fails when --check was given and ngspice is not installed.
void require_ngspice_for_check(const CommandLine& line);

/// --unit-capacitor-percent and --systematic-units, which all share that speak of built FPAA boards.
void add_mismatch_options(CommandLine& line);
/// `otherwise`: the plan's own.
fpaa::MismatchModel read_mismatch(const CommandLine& line, fpaa::MismatchModel otherwise);

/// --with-holds and --without-holds, of what reads plans.
void add_hold_options(CommandLine& line);
bool as_it_runs(const CommandLine& line);

/// --opamp-bandwidth-hz and --opamp-gain.
void add_slow_options(CommandLine& line);
fpaa::SlowParts read_slow_parts(const CommandLine& line);

/// --unit-capacitance-f and --noise-temperature-k.
void add_noise_options(CommandLine& line);
fpaa::NoiseModel read_noise_model(const CommandLine& line);

/// How long and how finely a reference is made where nobody says: 1 s in steps of 1 ms; or three periods of 500 samples (a
/// chirp or multisine: 20 samples of its highest frequency).
enum class UsualLength { second, periods };

/// --frequency-hz, --amplitude, … of a reference that the program makes.
void add_reference_options(CommandLine& line, UsualLength usual);
/// What those say of a reference of this kind.
simulate::ReferenceSpec read_reference_options(const CommandLine& line, const std::string& kind,
                                               UsualLength usual);
/// A kind that can be made, not a file of that name.
bool names_a_reference(const std::string& text);

/// The sections without their delay, which no circuit of poles and zeros makes; says so in a note.
Sections rational_part(Sections sections, const std::string& file);

/// Of a sections.json, or of what `tune` writes: controller and filter. `folder` is where the document lies.
Sections sections_of(const Node& node, const std::filesystem::path& folder, Provenance& from);

/// Several of them as one: what is built has them one after the other.
Sections read_rational_series(const std::vector<std::string>& files, Provenance& from);

/// --load-stroke, of commands that read a disturbance.
void add_load_option(CommandLine& line);

}  // namespace bodesmith::cli
