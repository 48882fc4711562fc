#pragma once

#include <span>

#include "base/json_fwd.hpp"
#include "chain/trained.hpp"
#include "identify/stage_fit.hpp"

namespace bodesmith::identify {

/// A fit as reports have it: errors in training and held out, parameters with their deviations; or why it was refused.
Json to_json(const StageFit& fit);
/// What the fitted model has seen, for its table [trained].
chain::Trained trained_of(const StageFit& fit, std::span<const TimeRecord> training, double skip_s);

}  // namespace bodesmith::identify
