#pragma once

namespace bodesmith {

/// Why an iteration ended. What it returns is its best point in every case but `not_runnable`.
enum class Termination {
  gradient,        ///< no descent is left: the optimality conditions hold to the tolerance
  step,            ///< the next step would be too short to matter
  cost,            ///< an iteration gains less than the tolerance
  max_iterations,  ///< the iterations are used up; more of them may help
  stopped,         ///< the caller asked it to stop
  not_runnable,    ///< the function could not be evaluated at the start (or nowhere near the best point)
};

/// True for the ends that mean a (local) minimum: gradient, step and cost.
constexpr bool converged(Termination termination) {
  return termination == Termination::gradient || termination == Termination::step ||
         termination == Termination::cost;
}

}  // namespace bodesmith
