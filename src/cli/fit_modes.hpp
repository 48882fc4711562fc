#pragma once

#include "cli/command_line.hpp"

namespace bodesmith::cli {

/// The kinds of fit, one file each.
void add_cascade_options(CommandLine& line);
int fit_to_cascade(const CommandLine& line);

void add_direct_options(CommandLine& line);
int fit_to_sections(const CommandLine& line);

void add_waveform_options(CommandLine& line);
int fit_to_waveform(const CommandLine& line);

void add_measured_options(CommandLine& line);
int fit_to_measurement(const CommandLine& line);

}  // namespace bodesmith::cli
