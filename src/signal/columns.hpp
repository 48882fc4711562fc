#pragma once

#include <string>
#include <string_view>

/// Names of the columns that more than one CSV file has; units are part of the name.
namespace bodesmith::column {

inline constexpr std::string_view time_s = "time_s";
inline constexpr std::string_view input = "u";      ///< what drives the stage
inline constexpr std::string_view output = "y";     ///< what it answers
inline constexpr std::string_view reference = "r";  ///< what a loop or an inverse shall follow

inline constexpr std::string_view frequency_hz = "frequency_hz";
inline constexpr std::string_view gain = "gain";  ///< linear magnitude
inline constexpr std::string_view magnitude_db = "magnitude_db";
inline constexpr std::string_view phase_deg = "phase_deg";
inline constexpr std::string_view coherence = "coherence";
inline constexpr std::string_view weight = "weight";

}  // namespace bodesmith::column

namespace bodesmith {

/// A column's name as the program knows it, and what its cells are multiplied with.
struct ColumnWord {
  std::string name;
  double scale = 1.0;
};

/// Other words that people use for the same column: gain_db and magnitude_dB are magnitude_db, frequency_kHz is frequency_hz
/// times 1000, time_ms is time_s over 1000, phase is phase_deg. Any other name stays.
ColumnWord column_word(std::string_view given);

}  // namespace bodesmith
