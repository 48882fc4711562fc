#pragma once

#include <vector>

#include "faults/finding.hpp"

namespace bodesmith::faults {

/// Two faults at once: each of the best single ones with every other, first under the covariance of the first, the best
/// dozen then with both sizes free; then the best seconds with every other in the same way. `singles` is sorted, best first.
std::vector<Finding> pairs_of(const Board& board, const std::vector<Finding>& singles,
                              const std::vector<Fault>& faults, const std::vector<double>& log_priors,
                              double log_prior_of_two, const Noise& noise);

}  // namespace bodesmith::faults
