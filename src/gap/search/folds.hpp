#pragma once

#include <vector>

#include "gap/experiment.hpp"
#include "gap/model.hpp"

namespace bodesmith::gap {

/// Residuals of a fitted model over the training records, each fold of them as a fit to the others leaves it:
/// what a term earns on data that did not choose its values. With J the sensitivities at the fitted values
/// and r the residuals, leaving fold k out moves the values by
///     d_k = -(J'J - J_k'J_k + P)^-1 (J'r - J_k'r_k),
/// and the fold's residuals become r_k + J_k d_k (Gauss-Newton; P: what is known of the unknowns beforehand).
/// Empty when the model cannot be run.
enum class Folds {
  records,    ///< each record is one
  stretches,  ///< the same fifth of every record is one; of a frequency response every fifth point
};
std::vector<double> folded_residuals(const Model& model, const Experiments& train, Folds folds);

/// Records where there are several, unless one of them alone leaves the model's values open (its fold would
/// then show that and nothing else); stretches otherwise.
Folds suitable_folds(const Model& model, const Experiments& train);

}  // namespace bodesmith::gap
