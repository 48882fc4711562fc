#pragma once

#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// Log evidence of a model fitted to the records, with what its names cost (Term::log_prior):
///
///     ln p(names) + L/T - 1/2 sum_i ((v_i - g_i)/s_i)^2 - 1/2 ln det(1 + R^1/2 J'J R^1/2 / T)
///
/// Laplace's approximation of the integral of likelihood times prior over all unknowns. L is the log likelihood of what the model leaves
/// under noise as it is: white noise on noise that forgets itself exponentially (signal/red_noise.hpp), its sizes and correlation refitted
/// with every model and its colour paid for, so that what a model leaves unexplained is noise that costs in every sample, and slow noise does
/// not feign significance; innovations are Student's t, as corners and jumps that a model leaves are no Gaussian noise. Of a response it is
/// Gaussian and white over its points. J are the sensitivities, made white by the same filter. R are the prior variances: s^2 of a free
/// parameter of the base model, given as g; of a term's unknown that of an even density over the range that its effect states (in the
/// logarithm where it is searched so), or of five typical changes where that is less; a weight of a bank is 0 or not with even odds. The
/// last sum is thus Occam's factor, the posterior's width over the prior's (MacKay, Neural Computation 4 (1992) 415). T tempers the likelihood,
/// as no form of the catalogue is exactly right (Gruenwald and van Ommen, Bayesian Analysis 12 (2017) 1069). Minus infinity where the model
/// cannot be run.
double log_evidence(const Model& model, const Experiments& train);

/// The relative fall of the sum of squares that changes a model's odds by a twentieth (kTied), which decides nothing: a candidate's fit ends
/// where an iteration brings no more.
double least_telling_drop(const Experiments& records);

/// What a name more costs: each of the catalogue is as likely as any other.
double log_share_of_name();

}  // namespace bodesmith::gap
