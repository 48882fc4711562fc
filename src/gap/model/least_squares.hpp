#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gap/model/model.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith::gap {

/// Residuals at some values of the unknowns, into `out`; false when the model cannot be run there.
using Residuals = std::function<bool(std::span<const double> values, std::vector<double>& out)>;

struct LeastSquaresOptions {
  int iterations = 30;
  double cost_tolerance = 1e-7;  ///< relative drop of the sum of squares at which it stops
  std::function<bool()> stop;    ///< looked at every iteration
  int threads = 1;               ///< from which differences call the residuals at once
};

struct LeastSquaresResult {
  std::vector<double> values;
  double rms = 0.0;
  Termination termination = Termination::not_runnable;
  int runs = 0;  ///< of the model; 0: not even the start could be run
  std::vector<double> residuals;
  /// Standard deviations for white residuals, and the condition number of the column-scaled Jacobian.
  std::vector<double> deviation;
  double condition_number = 0.0;

  /// The model could be run: there are values and residuals, whyever the fit ended.
  bool usable() const { return runs > 0; }
};

/// The bounded fit of numeric/optimisation/least_squares.hpp over a model's unknowns, with rank-one updates of the
/// Jacobian, since a run of the model is what costs.
LeastSquaresResult least_squares(const std::vector<Unknown>& unknowns, const Residuals& residuals,
                                 const LeastSquaresOptions& options = {});

/// Columns d(residual)/d(unknown, in search coordinates) at the given values; empty columns where it cannot
/// be run.
std::vector<std::vector<double>> sensitivities(const std::vector<Unknown>& unknowns,
                                               const Residuals& residuals, const std::vector<double>& at,
                                               int threads = 1);

}  // namespace bodesmith::gap
