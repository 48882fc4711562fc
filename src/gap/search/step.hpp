#pragma once

#include <vector>

#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// A candidate of a round as a step behind `before`. In the ranking that the step keeps it has this outcome, and what another judgement
/// had named is worse.
Step step_of(const Model& before, const Ranked& chosen, std::vector<Ranked> ranking,
             CandidateOutcome outcome = CandidateOutcome::named);

}  // namespace bodesmith::gap
