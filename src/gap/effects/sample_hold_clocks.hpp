#pragma once

#include <cstddef>
#include <vector>

#include "gap/proposal.hpp"
#include "gap/scene.hpp"
#include "signal/red_noise.hpp"

/// How the clock of a missing sample-and-hold is found in the residual of time records. A staircase needs the
/// clock to within a fraction of a cycle over the record, so each search begins with the first samples, where
/// a coarse comb of clocks will do; most refine the best ones as the look grows longer.
namespace bodesmith::gap {

/// Delay that would explain most of the residual, in seconds; 0 when none does.
double mean_lag_s(const Scene& scene);

/// Clocks of a hold at `at`, the residual likened to what it leaves. `guess_hz` above 0: to its stairs and lag, of clocks around that;
/// otherwise to its stairs apart from their mean lag, which free corners of the model may have taken over. Linear dynamics behind it
/// soften the stairs: the residual is run through them backwards. `half`: the hold acts half a cycle late. `noise`, where it has a
/// size: of the residual made white by it, in which faint stairs stand out from what free corners leave of a lag.
Starts clocks_of_hold(const Scene& scene, std::size_t at, bool half, double guess_hz = 0.0,
                      const RedNoise& noise = {});

}  // namespace bodesmith::gap
