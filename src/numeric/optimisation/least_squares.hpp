#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

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

/// A number that a fit may change: where it starts, its bounds, and how it is searched.
struct SearchVariable {
  double value = 0.0;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool logarithmic = false;  ///< searched as ln(value); value, min > 0. Otherwise as value/scale
  double scale = 1.0;        ///< size of a typical change (linear ones)
};

/// Residuals at some values of the unknowns; false when the model cannot be run there.
using Residuals = std::function<bool(const Eigen::VectorXd& values, Eigen::VectorXd& residuals)>;
/// Derivatives of the residuals (rows) by the values (columns).
using Jacobian = std::function<void(const Eigen::VectorXd& values, Eigen::MatrixXd& derivatives)>;

struct LeastSquaresOptions {
  int max_iterations = 30;
  double cost_tolerance = 1e-7;  ///< relative drop of the sum of squares at which it stops
  /// Forward differences in search coordinates: large enough for an engine's own rounding, small against
  /// curvature. Without effect where `jacobian` is given.
  double difference = 1e-4;
  Jacobian jacobian = {};
  /// The Jacobian is kept through up to two rank-one updates while they go on paying: for models whose run is
  /// expensive.
  bool broyden = true;
  bool uncertainty = true;  ///< whether gram and deviation are asked for
  double initial_damping = 1e-4;
  /// Of directions that change nothing (nearly) rounding decides where they are taken, by 1/least_damping of it.
  double least_damping = 1e-12;
  double max_step = std::numeric_limits<double>::infinity();  ///< of any unknown, in search coordinates
  /// Moves values within the bounds to where the model is defined, for what no bounds can say.
  std::function<void(Eigen::VectorXd& values)> project = {};
  std::function<bool()> stop = {};  ///< looked at every iteration
  /// With more than one, differences call the residuals from so many threads at once. The result does not depend on it.
  int threads = 1;
};

struct LeastSquaresResult {
  Eigen::VectorXd values;
  Eigen::VectorXd residuals;  ///< empty: the model cannot be run at the start
  double cost = 0.0;          ///< sum of the squared residuals
  Termination termination = Termination::not_runnable;
  int runs = 0;  ///< of the model
  /// JᵀJ with respect to the values, from the last Jacobian.
  Eigen::MatrixXd gram;
  /// Standard deviations of the values for white residuals; infinite for what changes nothing.
  Eigen::VectorXd deviation;
};

/// min |r(x)|² within bounds by Levenberg and Marquardt (Marquardt, J. SIAM 11 (1963) 431) with Nielsen's
/// rule for the damping (IMM-REP-1999-05, Technical University of Denmark) and Broyden's rank-one updates of
/// the Jacobian (Math. Comp. 19 (1965) 577). Unknowns that would go beyond a bound go to it, and the others
/// take the step that is then best for them (clipping alone would stall among many weights that may not be
/// negative).
LeastSquaresResult least_squares(const std::vector<SearchVariable>& unknowns, const Residuals& residuals,
                                 const LeastSquaresOptions& options = {});

/// Columns d(residual)/d(unknown, in search coordinates) by differences at the given values; empty columns
/// where it cannot be run. `threads`: LeastSquaresOptions::threads.
std::vector<Eigen::VectorXd> sensitivities(const std::vector<SearchVariable>& unknowns,
                                           const Residuals& residuals, const Eigen::VectorXd& values,
                                           int threads = 1);

/// Standard deviations from the normal matrix JᵀJ and the residual: σ² (JᵀJ)⁻¹ widened by (1+ρ)/(1−ρ), ρ the
/// residual's correlation from sample to sample (an AR(1) residual carries that many fewer independent
/// samples). Infinite where JᵀJ is singular.
Eigen::VectorXd parameter_deviation(const Eigen::MatrixXd& gram, const Eigen::VectorXd& residual);

}  // namespace bodesmith
