#pragma once

#include <vector>

#include "simulate/ode/ode_system.hpp"
#include "simulate/record/dense_signal.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

/// What is asked of the output: values at these rising times, and/or a dense signal.
struct OdeRequest {
  std::vector<double> times;
  bool right_limits = false;  ///< of the output at jumps
  std::vector<double>* values = nullptr;
  std::vector<double>* drive = nullptr;  ///< the input of the first part at the same times
  DenseSignal* dense = nullptr;
};

/// CVODE from the system's states to the end of its input. It starts again at every corner of the input,
/// where a curve has a corner, where the input of a memory turns, where a slew limit sets in or ends, and at
/// the samples of a controller. `shortest_detail_s`: of the input, bounds the step where nothing else does.
/// Counts are added to `stats`. SolverFailure when CVODE gives up or blocks switch without end.
void solve_ode(OdeSystem& system, const Options& options, const OdeRequest& request, Stats& stats,
               double shortest_detail_s);

}  // namespace bodesmith::simulate
