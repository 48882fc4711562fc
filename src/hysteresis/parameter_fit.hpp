#pragma once

#include <Eigen/Core>
#include <functional>

namespace bodesmith::hysteresis {

/// Parameters of a model fitted to records.
struct LeastSquaresResult {
  Eigen::VectorXd x;
  double cost = 0.0;          ///< sum of the squared residuals
  Eigen::VectorXd deviation;  ///< standard deviation of each x, see parameter_deviation()
  int evaluations = 0;
  bool converged = false;
};

/// The bounded fit of numeric/least_squares.hpp for models that are cheap to run and smooth: a fresh Jacobian
/// every iteration, down to a relative drop of 1e-10. `typical` is the size of each parameter.
LeastSquaresResult least_squares(const std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& r)>& f,
                                 const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                 const Eigen::VectorXd& upper, const Eigen::VectorXd& typical,
                                 int iterations = 100);

}  // namespace bodesmith::hysteresis
