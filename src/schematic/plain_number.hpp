#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

namespace bodesmith::schematic {

/// A number as every simulator and every person reads it: exponents, never suffixes (1M is 1e-3 in SPICE).
inline std::string plain_number(double value) {
  return fmt::format("{:.12g}", value);
}

/// SPICE's own number: 4.7k, 1meg, 10uF. False where there is none.
bool spice_value(const std::string& text, double& value);

/// The words of a line, between blanks and tabs.
std::vector<std::string> words_of(std::string_view line);

}  // namespace bodesmith::schematic
