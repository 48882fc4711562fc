#pragma once

#include "cli/command_line.hpp"

namespace bodesmith::cli {

/// The subcommand for a whole fractional transfer function instead of a cascade.
void add_fractional_options(CommandLine& line);
int approximate_fractional(const CommandLine& line);

}  // namespace bodesmith::cli
