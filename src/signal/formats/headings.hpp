#pragma once

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
  double scale = 1.0;      ///< to Hz, rad/s, s, degrees, or the signal's unit without prefix
  std::string unit;        ///< as written; empty when the heading has none
  bool unit_known = true;  ///< of a frequency or time
  MagnitudeScale magnitude = MagnitudeScale::unknown;
};
Heading parse_heading(const std::string& text);
std::vector<Heading> parse_headings(const std::vector<std::string>& texts);

/// "(ms)", "dB", "[Hz]": a cell of a line of units.
bool is_unit_alone(const std::string& cell);

}  // namespace bodesmith::formats
