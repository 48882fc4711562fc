#pragma once

#include "gap/effect.hpp"
#include "gap/experiment.hpp"

namespace bodesmith::gap {

/// What the effects look at: the first training record under the present model.
Scene make_scene(const Model& model, const Experiments& train);

/// Samples after which a model forgets its initial state: seven times its slowest time constant.
std::size_t settling_samples(const chain::Chain& chain, double step_s);

/// A shorter look at a long record: the stretch of about `samples` samples with the most lively output, with
/// `lead` samples before it that are run but not scored.
TimeRecord lively_stretch(const TimeRecord& record, std::size_t lead, std::size_t samples);

}  // namespace bodesmith::gap
