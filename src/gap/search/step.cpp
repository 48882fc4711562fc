#include "gap/search/step.hpp"

#include <utility>

namespace bodesmith::gap {

Step step_of(const Model& before, const Ranked& chosen, std::vector<Ranked> ranking,
             CandidateOutcome outcome) {
  Step step;
  step.effect = chosen.effect;
  step.placed = chosen.placed;
  step.before = before;
  step.after = chosen.model;
  bool found = false;
  for (auto& r : ranking) {
    const bool own = !found && r.effect == chosen.effect && r.placed == chosen.placed &&
                     r.unknowns == chosen.unknowns && r.train_rms == chosen.train_rms;
    found = found || own;
    if (own)
      r.outcome = outcome;
    else if (r.outcome == CandidateOutcome::named)
      r.outcome = CandidateOutcome::worse;
  }
  step.ranking = std::move(ranking);
  return step;
}

}  // namespace bodesmith::gap
