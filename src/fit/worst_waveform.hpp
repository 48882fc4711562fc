#pragma once

#include "fit/curve_search.hpp"
#include "fit/waveform_problem.hpp"

namespace bodesmith {

/// The largest mean square error over the operating frequencies made smallest: sequential quadratic programming with
/// Gauss-Newton curvature in a trust region. `value` is its root.
SearchResult search_smallest_worst(const WaveformProblem& problem, const RootModel& model,
                                   const RootLimits& limits, Eigen::VectorXd theta, int iterations);

}  // namespace bodesmith
