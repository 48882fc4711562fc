#include "gap/search/acceptance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gap/runner.hpp"

namespace bodesmith::gap {
namespace {

void add_once(std::vector<std::string>& list, std::string name) {
  if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(std::move(name));
}

/// What speaks against a candidate on its own; not_judged: nothing.
CandidateOutcome objection_to(const AcceptanceOptions& options, const Ranked& r, double holdout_before) {
  const double gain = 1.0 - r.holdout_rms / holdout_before;
  if (!(gain >= options.min_gain)) return CandidateOutcome::no_heldout_gain;
  if (!is_significant(options, {gain, r.z, r.train_z})) return CandidateOutcome::not_significant;
  if (r.unknowns > options.max_unknowns) return CandidateOutcome::too_free;
  if (r.condition_number > options.max_condition) return CandidateOutcome::ill_conditioned;
  const auto& unknowns = r.model.terms().back().unknowns;
  const bool at_bound =
      unknowns.size() <= options.few_unknowns &&
      std::any_of(unknowns.begin(), unknowns.end(), [](const Unknown& u) { return u.at_bound(); });
  if (at_bound && gain < options.min_gain_at_bound) return CandidateOutcome::at_end_of_range;
  return CandidateOutcome::not_judged;
}

/// The first of the good candidates, unless more unknowns buy next to nothing: then one with fewer of them.
template <class Size>
Ranked* simplest_of_best(const AcceptanceOptions& options, const std::vector<Ranked*>& good, Size left) {
  const Ranked& best = *good.front();
  Ranked* winner = good.front();
  for (auto* r : good) {
    if (r->effective >= winner->effective) continue;
    const double worse = left(*r) / left(best) - 1.0;
    const auto fewer = static_cast<double>(best.effective - r->effective);
    if (worse < options.simpler_within + options.simpler_within_each * fewer) winner = r;
  }
  return winner;
}

/// How a good candidate stands to the one that was chosen; the step keeps its name where that matters.
CandidateOutcome compare(const AcceptanceOptions& options, const Ranked& r, const Ranked& winner,
                         Step& step) {
  const double worse = r.holdout_rms / winner.holdout_rms - 1.0;
  if (r.effect == winner.effect) {
    if (worse < options.tie_within && r.placed != winner.placed) add_once(step.also_placed, r.placed);
    return CandidateOutcome::other_place_or_form;
  }
  if (worse >= options.tie_within) return CandidateOutcome::worse;
  const std::string name(r.effect->name());
  // A rival with a little more freedom is as good a name when it is at least as near.
  const bool as_free =
      r.unknowns <= winner.unknowns ||
      (r.unknowns <= winner.unknowns + options.tie_more_unknowns && worse < options.tie_with_more_within);
  if (!as_free) {
    add_once(step.also_fit, name);
    return CandidateOutcome::also_fits_with_more_unknowns;
  }
  add_once(step.tied_with, name);
  return CandidateOutcome::tied;
}

Step make_step(const AcceptanceOptions& options, const Model& before, Ranked& winner, double control,
               const std::vector<Ranked*>& good) {
  Step step;
  step.effect = winner.effect;
  step.placed = winner.placed;
  step.before = before;
  step.after = winner.model;
  step.control_gain = control;
  winner.outcome = CandidateOutcome::named;
  for (auto* r : good) {
    if (r != &winner) r->outcome = compare(options, *r, winner, step);
  }
  return step;
}

}  // namespace

bool is_significant(const AcceptanceOptions& options, const Gain& gain) {
  // Training records, which were fitted, count for no more than twice what the held-out ones say.
  const double both = (gain.z + std::min(gain.train_z, 2.0 * gain.z)) / std::sqrt(2.0);
  return !(gain.z < options.min_significance || gain.train_z < options.min_significance ||
           both < options.min_combined);
}

double pooled_left(const Ranked& r, double train_before, double holdout_before) {
  return std::sqrt(0.5 * (r.train_rms * r.train_rms / (train_before * train_before) +
                          r.holdout_rms * r.holdout_rms / (holdout_before * holdout_before)));
}

Judgement judge(const SearchSetting& setting, const SearchRecords& records, const Model& before,
                std::vector<Ranked> ranking) {
  const auto& options = setting.options.acceptance;
  const double train_before = rms_of(before, records.train);
  const double holdout_before = rms_of(before, records.holdout);
  const auto left = [&](const Ranked& r) { return pooled_left(r, train_before, holdout_before); };
  std::stable_sort(ranking.begin(), ranking.end(),
                   [&](const Ranked& a, const Ranked& b) { return left(a) < left(b); });
  std::vector<Ranked*> good;
  for (auto& r : ranking) {
    const auto objection = objection_to(options, r, holdout_before);
    if (objection == CandidateOutcome::not_judged) {
      good.push_back(&r);
    } else {
      r.outcome = objection;
    }
  }
  while (!good.empty()) {
    Ranked* winner = simplest_of_best(options, good, left);
    const double control = control_gain(setting, records, before, *winner);
    const double gain = 1.0 - winner->holdout_rms / holdout_before;
    if (gain < options.control_factor * control) {
      winner->outcome = CandidateOutcome::no_more_than_control;
      std::erase(good, winner);
      continue;
    }
    Step step = make_step(options, before, *winner, control, good);
    std::stable_sort(ranking.begin(), ranking.end(),
                     [](const Ranked& a, const Ranked& b) { return a.holdout_rms < b.holdout_rms; });
    step.ranking = ranking;
    return {std::move(step), std::move(ranking)};
  }
  return {std::nullopt, std::move(ranking)};
}

}  // namespace bodesmith::gap
