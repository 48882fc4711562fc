#pragma once

#include "cli/command_line.hpp"

namespace bodesmith::cli {

/// A whole fractional transfer function instead of a cascade.
void add_fractional_options(boost::program_options::options_description& options);
int approximate_fractional(const CommandLine& line);

}  // namespace bodesmith::cli
