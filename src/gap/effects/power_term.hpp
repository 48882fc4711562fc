#pragma once

#include <vector>

#include "gap/effect.hpp"

namespace bodesmith::gap {

/// y = u + c u^power at every static place of the chain: what quadratic_nonlinearity and cubic_nonlinearity
/// propose. With s the size of the signal there, c starts at +-0.005/s^(power-1) and is bounded by
/// 2/s^(power-1).
void propose_power_term(const Scene& scene, const Effect& effect, int power, std::vector<Proposal>& out);

}  // namespace bodesmith::gap
