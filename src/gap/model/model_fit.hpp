#pragma once

#include <cstddef>

#include "gap/model/least_squares.hpp"
#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// A model with the values that a fit found, and how that went.
struct FittedModel {
  Model model;
  LeastSquaresResult result;
};

/// Refits all unknowns of the model on the records. What is known of them beforehand (Unknown::given) counts
/// as one more sample each, in units of the residual that is left in the end: a fit that began far off is
/// done again with the smaller unit. On as many threads as are allowed here (allowed_threads).
FittedModel fit(Model model, const Experiments& experiments, LeastSquaresOptions options = {});

/// Orthonormal directions over the samples from `first` on of what unknown initial states of the model's
/// dynamics add to its output.
Directions free_responses(const Model& model, const TimeExperiment& experiment, std::size_t first);

}  // namespace bodesmith::gap
