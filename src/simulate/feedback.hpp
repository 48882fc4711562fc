#pragma once

#include <optional>
#include <vector>

#include "chain/chain.hpp"
#include "signal/time_record.hpp"
#include "simulate/pid.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

/// Engine::exact: a linear plant in closed form from sample to sample; Engine::cvode:
/// any plant of dynamics, curves and rate-independent memory, with the events of ode_solve.hpp;
/// Engine::automatic: exact where there is a closed form. The feed-forward signal of a chain is worked out
/// before, F{r}; absent: none.
///
/// DesignError when the plant answers at once (no block of it is strictly proper, so that the loop would be
/// algebraic: put its amplifier's lowpass in), or has a clock or rate-dependent memory inside. A delay stands in the loop as
/// an all-pass, which is said.
LoopResult simulate_loop(const chain::Chain& plant, const std::optional<chain::Chain>& feedforward,
                         const PidController& controller, const TimeRecord& reference,
                         const Options& options = {});
/// The same with the feed-forward signal itself, one value a sample of the reference.
LoopResult simulate_loop(const chain::Chain& plant, const std::vector<double>& feedforward,
                         const PidController& controller, const TimeRecord& reference,
                         const Options& options = {});

}  // namespace bodesmith::simulate
