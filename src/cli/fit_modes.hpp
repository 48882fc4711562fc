#pragma once

#include "cli/command_line.hpp"

namespace bodesmith::cli {

/// The three ways to fit, one file each.
void add_cascade_options(boost::program_options::options_description& options);
int fit_to_cascade(const CommandLine& line);

void add_direct_options(boost::program_options::options_description& options);
int fit_to_sections(const CommandLine& line);

void add_waveform_options(boost::program_options::options_description& options);
int fit_to_waveform(const CommandLine& line);

}  // namespace bodesmith::cli
