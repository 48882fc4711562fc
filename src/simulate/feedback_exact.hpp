#pragma once

#include <variant>
#include <vector>

#include "chain/chain.hpp"
#include "signal/time_record.hpp"
#include "simulate/pid.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

/// A loop round a linear plant in closed form. Continuous controller: plant, integral and derivative filter
/// are one linear system driven by r and f,
///   x' = A x + b (f + control),  y = c x + y0,  e = r - y,
///   I' = ki e,  q' = w_d (e - q),  control = kp e + I + kd w_d (e - q),
/// stepped by its matrix exponential (hold_response.hpp). Sampled controller: the plant alone is stepped, its
/// drive a straight line plus the held control.
///
/// `parts` steps are taken where one would do; the difference between one and two is rounding. No closed form
/// when the plant is not linear or has a delay, when a continuous controller has limits, or when the
/// controller's period and the record's step are not whole multiples of each other.
using LoopOutcome = std::variant<LoopResult, NoClosedForm>;
LoopOutcome run_exact_loop(const chain::Chain& plant, const std::vector<double>& feedforward,
                           const PidController& controller, const TimeRecord& reference, Start start,
                           int parts);

}  // namespace bodesmith::simulate
