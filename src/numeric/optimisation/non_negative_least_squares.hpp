#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith {

struct NonNegativeResult {
  Eigen::VectorXd x;
  double cost = 0.0;  ///< ½ |A x − b|²
  double kkt = 0.0;   ///< |projected gradient| relative to |Aᵀ b| (scaled columns)
  int iterations = 0;
  Termination termination = Termination::max_iterations;
};

/// A linear map that is only known by its products; A is never formed.
struct LinearMap {
  Eigen::Index columns = 0;
  Eigen::Index rows = 0;
  std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)> apply;    ///< y = A x
  std::function<void(const Eigen::VectorXd& r, Eigen::VectorXd& g)> adjoint;  ///< g = Aᵀ r
};

struct NonNegativeOptions {
  double tolerance = 1e-9;  ///< stops at this kkt,
  int max_iterations = 1000;
  double min_gain = 1e-5;  ///< or when 50 iterations together gain less than this part of the cost
};

/// min ½ |A x − b|² over x ≥ 0 for the tens of thousands of weights of a Preisach plane, whose normal matrix would fill
/// gigabytes (tens of unknowns: bounded_least_squares()). Dostál's MPRGP (Modified Proportioning with Reduced Gradient
/// Projections, SIAM J. Optim. 7 (1997) 871): conjugate gradients on the free variables, projected steps when
/// a bound is met, release of bounds when the gradient there outweighs; finite for strictly convex problems.
/// `scale` > 0 where a column counts (its reciprocal length is a good choice), 0 keeps the variable at 0.
NonNegativeResult non_negative_least_squares(const LinearMap& map, const Eigen::VectorXd& b,
                                             const Eigen::VectorXd& start, const Eigen::VectorXd& scale,
                                             const NonNegativeOptions& options);

}  // namespace bodesmith
