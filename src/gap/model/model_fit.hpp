#pragma once

#include <Eigen/Core>

#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith::gap {

/// A model with the values that a fit found, and how that went.
struct FittedModel {
  Model model;
  LeastSquaresResult result;
  double rms = 0.0;  ///< of the records' residuals

  /// The model could be run: there are values and residuals, whyever the fit ended.
  bool usable() const { return result.runs > 0; }
};

/// Refits all unknowns of the model on the records. What is known of them beforehand (Unknown::given) counts
/// as one more sample each, in units of the residual that is left in the end: a fit that began far off is
/// done again with the smaller unit. On as many threads as are allowed here (allowed_threads).
FittedModel fit(Model model, const Experiments& experiments, LeastSquaresOptions options = {});

/// The same from the records alone and for one iteration: how firmly they hold the values that stand.
LeastSquaresResult held_by(const Model& model, const Experiments& experiments);

/// Columns d(residual)/d(unknown, in search coordinates) at the model's values; zeros where it cannot be run.
Eigen::MatrixXd sensitivities(const Model& model, const Experiments& experiments);

}  // namespace bodesmith::gap
