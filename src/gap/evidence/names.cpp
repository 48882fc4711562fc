#include "gap/evidence/names.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::gap {

bool is_name(const Ranked& r) {
  return std::isfinite(r.log_evidence) && r.outcome != CandidateOutcome::no_name &&
         r.outcome != CandidateOutcome::takes_too_little;
}

std::map<std::string, double> names_of_step(const Step& step) {
  double most = step.log_evidence_without;
  for (const auto& r : step.ranking) {
    if (is_name(r)) most = std::max(most, r.log_evidence);
  }
  // A model that cannot be run has no evidence.
  const auto odds = [&](double evidence) {
    return std::isfinite(evidence) ? std::exp(evidence - most) : 0.0;
  };
  std::map<std::string, double> held;
  held[""] = odds(step.log_evidence_without);
  for (const auto& r : step.ranking) {
    if (is_name(r)) held[std::string(r.effect->told())] += odds(r.log_evidence);
  }
  const std::string own(step.effect->told());
  if (held.count(own) == 0) held[own] = 1.0;
  double sum = 0.0;
  for (const auto& [name, weight] : held) sum += weight;
  for (auto& [name, weight] : held) weight /= sum;
  return held;
}

void judge_ranking(Step& step) {
  const std::string own(step.effect->told());
  for (const auto& [name, probability] : names_of_step(step)) {
    if (!name.empty() && name != own && probability >= kTied) step.tied_with.push_back(name);
  }
  const Ranked* best = nullptr;
  for (auto& r : step.ranking) {
    if (!is_name(r)) continue;
    if (r.effect->told() != own) {
      const bool tied = std::count(step.tied_with.begin(), step.tied_with.end(), r.effect->told()) > 0;
      r.outcome = tied ? CandidateOutcome::tied : CandidateOutcome::worse;
    } else if (r.placed == step.placed && best == nullptr) {
      r.outcome = CandidateOutcome::named;
      best = &r;
    } else {
      r.outcome = CandidateOutcome::other_place_or_form;
    }
  }
  for (const auto& r : step.ranking) {
    const bool there = std::count(step.also_placed.begin(), step.also_placed.end(), r.placed) > 0;
    if (best != nullptr && r.effect->told() == own && r.placed != step.placed && !there && is_name(r) &&
        r.log_evidence > best->log_evidence + std::log(kTied))
      step.also_placed.push_back(r.placed);
  }
}

}  // namespace bodesmith::gap
