#pragma once

#include <optional>
#include <vector>

#include "chain/chain.hpp"
#include "signal/time_record.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {

/// A PI or PID controller on the error e = r - y, in parallel form:
///   control = clamp(proportional e + integral \int e dt + derivative w_d s/(s + w_d) e, lower, upper).
/// While the clamp holds the control, the integral does not run further into it.
/// period_s = 0: continuous. Otherwise sampled at t = k period_s from the record's start and held: the
/// integral by trapezia, the derivative by backward differences.
struct PidController {
  double proportional = 0.0;
  double integral_per_s = 0.0;
  double derivative_s = 0.0;
  Hertz derivative_corner{1e4};
  double lower = -1e300;
  double upper = 1e300;
  double period_s = 0.0;
};

/// u = F{r} + control, y = P{u}: a feed-forward compensator (absent: no feed-forward) and the loop round the
/// plant, as the seeds' hybrid controllers. The whole loop is solved in CVODE with the events of ode_run.hpp;
/// the feed-forward signal is worked out before and taken as straight between samples.
struct LoopResult {
  std::vector<double> y;
  std::vector<double> drive;  ///< u
  std::optional<double> error_estimate;
  Stats stats;
};

/// DesignError when the plant answers at once (no block of it is strictly proper, so that the loop would be
/// algebraic: put its amplifier's lowpass in), or has a delay, clock or rate-dependent memory inside.
LoopResult simulate_loop(const chain::Chain& plant, const std::optional<chain::Chain>& feedforward,
                         const PidController& controller, const TimeRecord& reference,
                         const Options& options = {});

}  // namespace bodesmith::simulate
