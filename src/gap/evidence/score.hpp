#pragma once

#include <vector>

#include "gap/experiment.hpp"
#include "gap/model.hpp"

namespace bodesmith::gap {

/// Tempered log evidences of fitted models that are rivals for the same records,
///
///     -n' ln r - k/2 ln n',   n' = n/(T tau)
///
/// with r the rms that a model leaves of n samples and k its unknowns in use; minus infinity where it cannot be run. tau is the
/// correlation time of what the nearest of them leaves (of responses: 1), so that n' samples count as independent: what is slow is
/// charged by the few that coloured noise has of it. -n ln r is the likelihood of Gaussian noise of the most likely size, k/2 ln n Schwarz'
/// form of Laplace's integral (Ann. Statist. 6 (1978) 461). T tempers the likelihood, as no form of the catalogue is exactly right (Gruenwald
/// and van Ommen, Bayesian Analysis 12 (2017) 1069).
std::vector<double> log_evidences(const std::vector<const Model*>& rivals, const Experiments& train);

/// What a name more costs: each of the catalogue is as likely as any other.
double log_share_of_name();

}  // namespace bodesmith::gap
