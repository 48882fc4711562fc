#include "signal/columns.hpp"

#include <array>

#include "base/text.hpp"

namespace bodesmith {
namespace {

struct OtherWord {
  std::string_view word;  ///< in small letters
  std::string_view name;
  double scale;
};

constexpr std::array<OtherWord, 22> kOtherWords = {{
    {"gain_db", column::magnitude_db, 1.0},
    {"mag_db", column::magnitude_db, 1.0},
    {"magnitude_db", column::magnitude_db, 1.0},
    {"level_db", column::magnitude_db, 1.0},
    {"frequency_hz", column::frequency_hz, 1.0},
    {"frequency", column::frequency_hz, 1.0},
    {"freq", column::frequency_hz, 1.0},
    {"freq_hz", column::frequency_hz, 1.0},
    {"f_hz", column::frequency_hz, 1.0},
    {"frequency_khz", column::frequency_hz, 1e3},
    {"freq_khz", column::frequency_hz, 1e3},
    {"f_khz", column::frequency_hz, 1e3},
    {"phase_deg", column::phase_deg, 1.0},
    {"phase_rad", column::phase_deg, 57.295779513082323},
    {"time", column::time_s, 1.0},
    {"t", column::time_s, 1.0},
    {"t_s", column::time_s, 1.0},
    {"time_ms", column::time_s, 1e-3},
    {"t_ms", column::time_s, 1e-3},
    {"time_us", column::time_s, 1e-6},
    {"resistance_kohm", "resistance_ohm", 1e3},
    {"capacitance_nf", "capacitance_f", 1e-9},
}};

}  // namespace

ColumnWord column_word(std::string_view given) {
  const std::string small = lower_case(given);
  for (const OtherWord& other : kOtherWords) {
    if (small == other.word) return {std::string(other.name), other.scale};
  }
  return {std::string(given), 1.0};
}

}  // namespace bodesmith
