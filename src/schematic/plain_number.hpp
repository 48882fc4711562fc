#pragma once

#include <fmt/format.h>

#include <string>

namespace bodesmith::schematic {

/// A number as every simulator and every person reads it: exponents, never suffixes (1M is 1e-3 in SPICE).
inline std::string plain_number(double value) {
  return fmt::format("{:.12g}", value);
}

}  // namespace bodesmith::schematic
