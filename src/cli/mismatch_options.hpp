#pragma once

#include "cli/command_line.hpp"
#include "fpaa/device/mismatch.hpp"
#include "fpaa/network/settling.hpp"

namespace bodesmith::cli {

/// --unit-capacitor-percent and --systematic-units, which `fpaa`, `yield` and `fpaa trim` share.
void add_mismatch_options(CommandLine& line);
fpaa::MismatchModel read_mismatch(const CommandLine& line);

/// --opamp-bandwidth-hz and --opamp-gain.
void add_opamp_options(CommandLine& line);
fpaa::OpAmpModel read_opamp_model(const CommandLine& line);

/// --unit-capacitance-f and --noise-temperature-k.
void add_noise_options(CommandLine& line);
fpaa::NoiseModel read_noise_model(const CommandLine& line);

}  // namespace bodesmith::cli
