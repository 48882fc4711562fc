#pragma once

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
