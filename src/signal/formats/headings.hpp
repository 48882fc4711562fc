#pragma once

#include <optional>
#include <string>
#include <vector>

namespace bodesmith::formats {

enum class Quantity {
  frequency,
  angular_frequency,
  time,
  magnitude,
  phase,
  real,
  imaginary,
  coherence,
  signal
};
enum class MagnitudeScale { unknown, decibel, linear };

/// What a column's heading says: "Frequency (kHz)", "Channel 2 Phase (*)", "Trace 1: Gain: Magnitude (dB)", "V(out)".
struct Heading {
  std::string text;
  Quantity quantity = Quantity::signal;
  double scale =
      1.0;  ///< to Hz, rad/s, s, degrees, or the unit without prefix; below 0 of "-Im(Z)", "Phase lag"
  std::string unit;        ///< as written; empty when the heading has none
  bool unit_known = true;  ///< of anything but a signal
  bool logarithm = false;  ///< a frequency's, to base 10
  bool level = false;      ///< a magnitude of one signal (V, dBV, dBm), not of one over another
  bool quotient = false;   ///< a magnitude that says so itself: "Math (Ch B / Ch A)"
  MagnitudeScale magnitude = MagnitudeScale::unknown;
};
Heading parse_heading(const std::string& text);
std::vector<Heading> parse_headings(const std::vector<std::string>& texts);

/// The first column of a quantity from `from` on.
std::optional<std::size_t> first_of(const std::vector<Heading>& headings, Quantity quantity,
                                    std::size_t from = 0);
/// In Hz before in rad/s.
std::optional<std::size_t> frequency_column(const std::vector<Heading>& headings);
/// Whether headings say frequency or time, and with it a magnitude, a real part or a signal.
bool has_response_headings(const std::vector<Heading>& headings);
bool has_record_headings(const std::vector<Heading>& headings);

/// "(ms)", "dB", "[Hz]": a cell of a line of units.
bool is_unit_alone(const std::string& cell);

}  // namespace bodesmith::formats
