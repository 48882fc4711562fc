#pragma once

#include "cli/command_line.hpp"
#include "simulate/references.hpp"

namespace bodesmith::cli {

/// How long and how finely a reference is made where nobody says: 1 s in steps of 1 ms; or three periods of 500 samples (a
/// chirp or multisine: 20 samples of its highest frequency).
enum class UsualLength { second, periods };

/// --frequency-hz, --amplitude, … of a reference that the program makes.
void add_reference_options(CommandLine& line, UsualLength usual);
/// What those say of a reference of this kind.
simulate::ReferenceSpec read_reference_options(const CommandLine& line, const std::string& kind,
                                               UsualLength usual);
/// A kind that can be made, not a file of that name.
bool names_a_reference(const std::string& text);

}  // namespace bodesmith::cli
