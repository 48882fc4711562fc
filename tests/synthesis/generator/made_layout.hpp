#pragma once

#include <vector>

#include "synthesis/generator/layout.hpp"

namespace bodesmith::generator {

/// The layout of these polynomials, without gains that vary with the amplitude.
inline Layout layout_of(const std::vector<Polynomial>& branches, const Options& options = {}) {
  return make_layout(Input{branches, {}}, options);
}

}  // namespace bodesmith::generator
