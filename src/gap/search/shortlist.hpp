#pragma once

#include <vector>

#include "gap/proposal.hpp"
#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// A proposal with what a first look promised.
struct Promising {
  Proposal proposal;
  std::vector<std::size_t> best_starts;  ///< best first
  std::size_t places = 1;                ///< proposals of the same effect that were looked at
  double score = 0.0;  ///< predicted share, of the energy that the model's own unknowns leave
};

/// The first look: the residual is made orthogonal to everything that the model's own unknowns could still
/// explain; so is what each proposal's start values change in the output, and what its unknowns would change
/// further. The share of the residual that lies in their span is the score (a score test with the model
/// itself as the feature). Best first.
std::vector<Promising> shortlist(const Model& model, std::vector<Proposal> proposals,
                                 const Experiments& look);

}  // namespace bodesmith::gap
