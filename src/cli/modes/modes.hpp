#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/command_line.hpp"
#include "fit/direct/direct_fit.hpp"
#include "gap/search_options.hpp"

/// Subcommands that do several kinds of work have a file for each.
namespace bodesmith::cli {

/// The subcommand for a whole fractional transfer function instead of a cascade.
void add_fractional_options(CommandLine& line);
int approximate_fractional(const CommandLine& line);

/// `identify --disturbance`: its options in addition to those of `identify`, and the work.
void add_disturbance_options(CommandLine& line);
int identify_disturbance_mode(const CommandLine& line);

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

// `bodesmith diagnose` has three modes: a model and records (diagnose_command.cpp), a built board (--circuit, --plan) and
// the course of hidden effects (--course).

int run_diagnose_board(const std::vector<std::string>& arguments);
int run_diagnose_course(const std::vector<std::string>& arguments);

/// Diagnoses one record with one held out into a folder, as `diagnose` does.
void diagnose_into(const std::filesystem::path& folder, const std::filesystem::path& model,
                   const std::filesystem::path& data, const std::filesystem::path& holdout,
                   const gap::SearchOptions& options);

}  // namespace bodesmith::cli
