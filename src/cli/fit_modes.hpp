#pragma once

#include "cli/command_line.hpp"
#include "fit/direct_fit.hpp"

namespace bodesmith::cli {

/// The kinds of fit, one file each.
void add_cascade_options(CommandLine& line);
int fit_to_cascade(const CommandLine& line);

void add_direct_options(CommandLine& line);
int fit_to_sections(const CommandLine& line);
/// The options above; the masks' files are remembered in `from`.
DirectFitOptions read_direct_options(const CommandLine& line, Provenance& from);
/// Writes the sections and the summary; `why`: what made `fit` choose them by itself.
int write_direct_fit(const CommandLine& line, const DirectFit& fit, const Provenance& from, double seconds,
                     const std::string& why);

void add_waveform_options(CommandLine& line);
int fit_to_waveform(const CommandLine& line);

void add_measured_options(CommandLine& line);
int fit_to_measurement(const CommandLine& line);

}  // namespace bodesmith::cli
