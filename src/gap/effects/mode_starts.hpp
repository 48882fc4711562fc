#pragma once

#include <numbers>

#include "chain/block.hpp"
#include "gap/proposal.hpp"
#include "gap/scene.hpp"

namespace bodesmith::gap {

/// A mode that is damped more has no peak: it is two lags, which have names of their own.
constexpr double kMostDamping = std::numbers::sqrt2 / 2.0;

/// Natural frequency, damping and share of the modes that a response most lacks alongside a `parallel_modes` block of the
/// scene's model. With frequency and damping given, the measured response over that of the rest of the model,
///     T = c (1 + S) + g R/(1 + 2 zeta s/w + s^2/w^2),   S: what the block has already, R: as in the block,
/// is linear in c and g, so that each pair of them is tried, relative to |T|, and the best ones of either sign are
/// taken, apart in frequency.
Starts mode_starts(const Scene& scene, const chain::Block& modes);

}  // namespace bodesmith::gap
