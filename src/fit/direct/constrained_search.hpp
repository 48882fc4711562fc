#pragma once

#include <Eigen/Core>

#include "fit/direct/curve_target.hpp"

namespace bodesmith {

/// Sequential programming in a trust region: rms (quadratic programs) or largest weighted error (linear ones), with the
/// limits and masks as constraints. Masks are elastic: a violation counts kMaskCost times as much as an error.
SearchResult search_constrained(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                Eigen::VectorXd theta, bool least_squares, int iterations);

/// In pieces: `radius` is that of the trust region, which goes on where the last piece left it.
constexpr double kFirstRadius = 0.3;
SearchResult search_constrained(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                Eigen::VectorXd theta, bool least_squares, int iterations, double& radius);

/// Moves theta by the smallest steps until every error is 0 (more parameters than points).
SearchResult search_interpolation(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  Eigen::VectorXd theta, int iterations);

}  // namespace bodesmith
