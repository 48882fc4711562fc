#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

namespace bodesmith {

/// min |A x − y|² subject to x_i ≥ 0 for the columns marked `signed_columns[i] == false`, from G = AᵀA and c
/// = Aᵀy (Lawson and Hanson's active set in the form of Bro and de Jong). Ends at a point that satisfies the
/// Kuhn-Tucker conditions to `tolerance` relative to |c|∞, or after 3·n exchanges (`converged` is then
/// false).
struct NnlsResult {
  Eigen::VectorXd x;
  bool converged = true;
};
NnlsResult nnls(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                const std::vector<bool>& free_sign = {}, double tolerance = 1e-12);

/// Bounded nonlinear least squares by Levenberg and Marquardt with a forward-difference Jacobian; bounds by
/// projection.
struct LeastSquaresResult {
  Eigen::VectorXd x;
  double cost = 0.0;          ///< Σ r²
  Eigen::VectorXd deviation;  ///< standard deviation of each x, see parameter_deviation()
  int evaluations = 0;
  bool converged = false;
};
LeastSquaresResult least_squares(
    const std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& residual)>& f,
    const Eigen::VectorXd& start, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
    const Eigen::VectorXd& typical, int iterations = 100);

/// Standard deviations from the normal matrix JᵀJ and the residual: σ² (JᵀJ)⁻¹ widened by (1+ρ)/(1−ρ), ρ the
/// residual's correlation from sample to sample (an AR(1) residual carries that many fewer independent
/// samples). Infinite where JᵀJ is singular.
Eigen::VectorXd parameter_deviation(const Eigen::MatrixXd& gram, const Eigen::VectorXd& residual);

}  // namespace bodesmith
