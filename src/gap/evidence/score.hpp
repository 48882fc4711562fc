#pragma once

#include "gap/experiment.hpp"
#include "gap/model.hpp"

namespace bodesmith::gap {

/// Tempered log evidence of a fitted model,
///
///     [ln p(y | theta, M) - k/2 ln n]/T
///
/// with k unknowns in use and n samples; minus infinity where the model cannot be run. p(y | theta, M) is the exact likelihood of
/// what M leaves as white and red noise whose sizes and correlation are the most likely ones of that very rest
/// (signal/red_noise.hpp; of responses: white noise), so that coloured noise feigns nothing; k/2 ln n is Schwarz' form of
/// Laplace's integral (Ann. Statist. 6 (1978) 461). T tempers what a catalogue in which no form is exactly right would claim
/// (Gruenwald and van Ommen, Bayesian Analysis 12 (2017) 1069).
double log_evidence(const Model& model, const Experiments& train);

/// What a name more costs: each of the catalogue is as likely as any other.
double log_share_of_name();

}  // namespace bodesmith::gap
