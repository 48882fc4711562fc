#pragma once

#include <Eigen/Core>
#include <functional>

#include "numeric/least_squares.hpp"

namespace bodesmith::hysteresis {

/// The bounded fit of numeric/least_squares.hpp for models that are cheap to run and smooth: a fresh Jacobian
/// every iteration, down to a relative drop of 1e-10. `typical` is the size of each parameter. The deviations are those
/// of parameter_deviation(): a residual that remembers itself tells less.
LeastSquaresResult fit_parameters(const std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& r)>& f,
                                  const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                  const Eigen::VectorXd& upper, const Eigen::VectorXd& typical,
                                  int iterations = 100);

}  // namespace bodesmith::hysteresis
