#pragma once

#include <vector>

#include "base/units.hpp"

namespace bodesmith {

/// Bare numbers, for files and plots.
inline std::vector<double> hertz_values(const std::vector<Hertz>& frequencies) {
  std::vector<double> out;
  for (const Hertz f : frequencies) out.push_back(f.value);
  return out;
}

}  // namespace bodesmith
