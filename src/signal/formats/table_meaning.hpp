#pragma once

#include <span>
#include <string>
#include <vector>

#include "signal/formats/headings.hpp"
#include "signal/formats/number_table.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {

/// A choice that says the unit of a magnitude or phase and no name: "db", "gain", "ohm", "deg", "rad".
bool is_scale_word(const std::string& choice);
/// Phases without a unit. All within 4 pi they may be radians as well as degrees, which is an InputError that says what
/// to do `instead`, unless the user chose (FILE:deg, FILE:rad).
std::vector<double> degrees_of(const Source& source, std::string_view name, std::vector<double> values,
                               std::string_view instead, Words& words);

/// Magnitudes in dB. A scale that is not known follows from the choice (FILE:db, FILE:gain, FILE:ohm) or the values:
/// one of 0 or less is dB, all within (0, 4] are linear, all from 30 to 150 a sound pressure level in dB; anything else
/// is an InputError that asks for the choice.
std::vector<double> decibels(const Source& source, MagnitudeScale scale, std::span<const double> values,
                             Words& words);
/// i/sample_hz, and a note of it.
std::vector<double> sampled_times(double sample_hz, std::size_t count, Words& words);
/// Frequencies in Hz.
std::vector<double> hertz(const Heading& heading, std::vector<double> values, Words& words);

/// Whether the headings say a record: a time, or signals whose times the user or the lines above say.
bool is_record(const Source& source, const NumberTable& table, const std::vector<Heading>& headings);

/// What a table with headings says: a response (frequency, magnitude or real and imaginary part, phase) or a record
/// (time, or the sampling rate that the user gave, and signals), columns chosen by the user's words. Of several magnitudes
/// a quotient comes first ("Math (Ch B / Ch A)"), then S21, dB before linear ones, levels of one signal (Vpp, dBV) last;
/// several of one kind are left to the user, a level without a phase is a spectrum: both InputErrors, as are units that
/// are not known of a column that is used.
Foreign read_by_headings(const Source& source, NumberTable table, Words words);

}  // namespace bodesmith::formats
