#pragma once

#include <span>

#include "base/documents/json_fwd.hpp"
#include "chain/chain.hpp"
#include "identify/stage_fit.hpp"

namespace bodesmith::identify {

/// A fit as reports have it: errors in training and held out, parameters with their deviations; or why it was refused.
Json to_json(const StageFit& fit);
/// The fitted stage as model.toml has it: with a free gain and offset behind it where nothing is free (what diagnose may
/// refit before it blames what is missing), and with what it has seen in its table [trained].
chain::Chain identified_model(const StageFit& fit, std::span<const TimeRecord> training, double skip_s);

}  // namespace bodesmith::identify
