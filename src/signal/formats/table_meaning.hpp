#pragma once

#include <span>
#include <string>
#include <vector>

#include "signal/formats/headings.hpp"
#include "signal/formats/number_table.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {

/// Whether headings say frequency or time, and with it a magnitude, a real part or a signal.
bool has_response_headings(const std::vector<Heading>& headings);
bool has_record_headings(const std::vector<Heading>& headings);

/// Magnitudes in dB. A scale that is not known follows from the choice (FILE:db, FILE:gain, FILE:ohm) or the values:
/// one of 0 or less is dB, all within (0, 4] are linear, all from 30 to 150 a sound pressure level in dB; anything else
/// is an InputError that asks for the choice.
std::vector<double> decibels(const Source& source, MagnitudeScale scale, std::span<const double> values,
                             Words& words);
/// Frequencies in Hz.
std::vector<double> hertz(const Heading& heading, std::vector<double> values, Words& words);

/// What a table with headings says: a response (frequency, magnitude or real and imaginary part, phase) or a record
/// (time, signals), columns chosen by the user's words.
Foreign read_by_headings(const Source& source, NumberTable table, Words words);

}  // namespace bodesmith::formats
