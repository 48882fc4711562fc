#pragma once

#include <cmath>

#include "lti/sections.hpp"

namespace bodesmith::circuit {

/// Where one op-amp ends to be enough for a high-pass: above, Sallen and Key's form asks too much of its parts.
constexpr double kSallenKeyMaxQuality = 3.0;

/// Two poles, two zeros at the origin.
inline bool is_high_pass(const Section& section) {
  return section.poles.size() == 2 && section.zeros.size() == 2 && std::abs(section.zeros[0]) == 0.0 &&
         std::abs(section.zeros[1]) == 0.0;
}

/// Q of two poles.
inline double quality_of(const Section& section) {
  return std::abs(section.poles[0]) / std::abs((section.poles[0] + section.poles[1]).real());
}

}  // namespace bodesmith::circuit
