#pragma once

#include <vector>

#include "synthesis/generator/circuit.hpp"

namespace bodesmith::generator {

/// The layout of these polynomials, without gains that vary with the amplitude.
inline DisturbanceCircuit layout_of(const std::vector<Polynomial>& branches,
                                    const Options& options = Options()) {
  return make_layout(Input{branches, {}}, options);
}

}  // namespace bodesmith::generator
