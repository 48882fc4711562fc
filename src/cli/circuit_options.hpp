#pragma once

#include "cli/command_line.hpp"
#include "schematic/opamp_library.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::cli {

/// --realization, --series and --capacitor-series, which `spice` and `yield` share.
void add_circuit_options(CommandLine& line);
/// A circuit with exact resistors has exact capacitors unless --capacitor-series says otherwise.
circuit::RealiseOptions read_circuit_options(const CommandLine& line);

/// --stock, limits of the values, --isolation-ohm, --opamp, --opamp-library.
void add_parts_options(CommandLine& line);
/// Those and add_circuit_options' together.
circuit::RealiseOptions read_parts_options(const CommandLine& line, Provenance& from);
/// The limits are the user's own, not the realisation's.
bool parts_limits_given(const CommandLine& line);
/// --opamp auto.
bool automatic_opamp(const CommandLine& line);
schematic::OpAmpLibrary opamp_library_of(const CommandLine& line, Provenance& from);

/// Adds --check.
void add_check_option(CommandLine& line, const std::string& what);
/// Fails when --check was given and ngspice is not installed.
void require_ngspice_for_check(const CommandLine& line);

}  // namespace bodesmith::cli
