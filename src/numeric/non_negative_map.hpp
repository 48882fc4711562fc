#pragma once

#include <Eigen/Dense>
#include <functional>

namespace bodesmith {

/// min ½ |A x − b|² over x ≥ 0 for a linear map that is only known by its products; x may have many thousands
/// of entries and A is never formed. Dostál's MPRGP (Modified Proportioning with Reduced Gradient
/// Projections, SIAM J. Optim. 7 (1997) 871): conjugate gradients on the free variables, projected steps when
/// a bound is met, release of bounds when the gradient there outweighs; finite for strictly convex problems.
struct NonNegativeMap {
  Eigen::Index columns = 0;
  Eigen::Index rows = 0;
  std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)> apply;    ///< y = A x
  std::function<void(const Eigen::VectorXd& r, Eigen::VectorXd& g)> adjoint;  ///< g = Aᵀ r
};
struct NonNegativeResult {
  Eigen::VectorXd x;
  double cost = 0.0;  ///< ½ |A x − b|²
  double kkt = 0.0;   ///< |projected gradient| relative to |Aᵀ b| (scaled columns)
  int iterations = 0;
  bool converged = false;
};
/// `scale` > 0 where a column counts (its reciprocal length is a good choice), 0 keeps the variable at 0.
/// Stops at kkt ≤ tolerance, after `iterations`, or when 50 iterations together gain less than `least_gain`
/// of the cost.
NonNegativeResult solve_non_negative(const NonNegativeMap& map, const Eigen::VectorXd& b,
                                     const Eigen::VectorXd& start, const Eigen::VectorXd& scale,
                                     double tolerance, int iterations, double least_gain = 1e-5);

}  // namespace bodesmith
