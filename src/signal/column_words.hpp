#pragma once

#include <string>
#include <string_view>

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
