#pragma once

#include <Eigen/Core>
#include <functional>

#include "fit/curve_target.hpp"
#include "fit/root_model.hpp"

namespace bodesmith {

struct SearchResult {
  Eigen::VectorXd theta;
  double value = 0.0;  ///< weighted rms (least squares) or largest weighted error (Chebyshev), Np
};

/// Weighted errors and their derivatives.
void curve_errors(const RootModel& model, const CurveTarget& target, const Eigen::VectorXd& theta,
                  Eigen::VectorXd& error, Eigen::MatrixXd* slope);

/// Errors at theta and (unless null) their derivatives.
using ErrorFunction =
    std::function<void(const Eigen::VectorXd& theta, Eigen::VectorXd& error, Eigen::MatrixXd* slope)>;

/// Levenberg-Marquardt inside the limits. Fast, for screening starts.
SearchResult search_least_squares(const RootModel& model, const ErrorFunction& errors_at,
                                  const RootLimits& limits, Eigen::VectorXd theta, int iterations);
/// The same for a curve; masks are left aside.
SearchResult search_least_squares(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  Eigen::VectorXd theta, int iterations);

}  // namespace bodesmith
