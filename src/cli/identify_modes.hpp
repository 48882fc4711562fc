#pragma once

#include "cli/command_line.hpp"

namespace bodesmith::cli {

/// `identify --disturbance`: its options beside those of `identify`, and the work.
void add_disturbance_options(CommandLine& line);
int identify_disturbance_mode(const CommandLine& line);

}  // namespace bodesmith::cli
