#pragma once

#include "circuit/realise.hpp"
#include "cli/command_line.hpp"

namespace bodesmith::cli {

/// --realization, --series and --capacitor-series, which `spice` and `yield` share.
void add_circuit_options(CommandLine& line);
/// A circuit with exact resistors has exact capacitors unless --capacitor-series says otherwise.
circuit::RealiseOptions read_circuit_options(const CommandLine& line);

/// Adds --check.
void add_check_option(CommandLine& line, const std::string& what);
/// Fails when --check was given and ngspice is not installed.
void require_ngspice_for_check(const CommandLine& line);

}  // namespace bodesmith::cli
