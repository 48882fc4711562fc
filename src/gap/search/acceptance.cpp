#include "gap/search/acceptance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gap/evidence/score.hpp"
#include "gap/runner.hpp"
#include "gap/search/round.hpp"
#include "gap/search/step.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

void add_once(std::vector<std::string>& list, std::string name) {
  if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(std::move(name));
}

/// What a round's candidates are measured against.
struct Bar {
  double folds_rms = 0.0;  ///< of the model before
  double first_gap = 0.0;  ///< gap_to_explain(); 0: this is the first term
};

/// What speaks against a candidate on its own; not_judged: nothing.
CandidateOutcome objection_to(const AcceptanceOptions& options, const Ranked& r, const Bar& bar) {
  const Gain gain{1.0 - r.folds_rms / bar.folds_rms, r.least_z(),
                  std::sqrt(std::max(0.0, bar.folds_rms * bar.folds_rms - r.folds_rms * r.folds_rms))};
  const auto too_little = too_little_of(options, *r.effect, r.unknowns, gain, bar.first_gap);
  if (too_little != CandidateOutcome::not_judged) return too_little;
  if (r.unknowns > options.max_unknowns) return CandidateOutcome::too_free;
  if (r.condition_number > options.max_condition) return CandidateOutcome::ill_conditioned;
  if (r.no_name) return CandidateOutcome::no_name;
  const auto& unknowns = r.model.terms().back().unknowns;
  const bool at_bound =
      unknowns.size() <= options.few_unknowns &&
      std::any_of(unknowns.begin(), unknowns.end(), [](const Unknown& u) { return u.at_bound(); });
  if (at_bound && gain.share < options.min_gain_at_bound) return CandidateOutcome::at_end_of_range;
  return CandidateOutcome::not_judged;
}

/// Standard deviations by which one fit leaves more on the folds than another.
double significantly_worse(const std::vector<double>& folds, const std::vector<double>& than) {
  if (folds.empty() || folds.size() != than.size()) return 1e9;
  return improvement_z(folds, than);
}

/// By a part of the rms and in standard deviations: under noise that is as slow as what the two do, a larger part is chance.
bool hardly_worse(const AcceptanceOptions& options, double worse, const std::vector<double>& folds,
                  const std::vector<double>& than) {
  if (worse >= options.tie_within_chance) return false;
  const double z = significantly_worse(folds, than);
  return z < (worse < options.tie_within ? options.tie_significance : options.chance_significance);
}

bool as_good(const AcceptanceOptions& options, const Ranked& r, const Ranked& than, double surely) {
  return as_good_on_folds(options, {r.folds_rms, r.folds}, {than.folds_rms, than.folds}, surely);
}

/// The candidate of the greatest evidence, of those that were in the running. Folds say whether a term earns its place; they are
/// found without fitting again, and where a term is far from linear (a limited rate, a delay) they do not say which one comes
/// nearest.
Ranked* most_evident(const SearchRecords& records, const std::vector<Ranked*>& good) {
  std::vector<Ranked*> running;
  std::vector<const Model*> models;
  for (auto* r : good) {
    if (r->folds.empty() && r != good.front()) continue;
    running.push_back(r);
    models.push_back(&r->model);
  }
  if (running.size() < 2) return good.front();
  const auto evidence = log_evidences(models, records.train);
  return running[static_cast<std::size_t>(std::max_element(evidence.begin(), evidence.end()) -
                                          evidence.begin())];
}

/// Of another effect that fits as well as a far-fetched one, with hardly more unknowns: that one.
Ranked* nearest_at_hand(const AcceptanceOptions& options, const std::vector<Ranked*>& good, Ranked* winner) {
  if (!winner->far_fetched) return winner;
  for (auto* r : good) {
    if (r->far_fetched || r->effect == winner->effect ||
        r->effective > winner->effective + options.at_hand_more_unknowns)
      continue;
    if (as_good(options, *r, *winner, options.at_hand_within)) return r;
  }
  return winner;
}

/// How a good candidate stands to the one that was chosen; the step keeps its name where that matters.
CandidateOutcome compare(const AcceptanceOptions& options, const Ranked& r, const Ranked& winner,
                         Step& step) {
  const bool alike = as_good(options, r, winner, options.tie_surely_within);
  if (r.effect == winner.effect) {
    if (alike && r.placed != winner.placed) add_once(step.also_placed, r.placed);
    return CandidateOutcome::other_place_or_form;
  }
  if (!alike || (r.far_fetched && !winner.far_fetched)) return CandidateOutcome::worse;
  const std::string name(r.effect->name());
  // A rival with a little more freedom is as good a name when that freedom shows.
  const bool freedom_shows = r.train_rms < winner.train_rms &&
                             r.unknowns <= winner.unknowns + options.tie_more_unknowns &&
                             significantly_worse(winner.folds, r.folds) > options.freedom_significance;
  if (r.unknowns > winner.unknowns && !freedom_shows) {
    add_once(step.also_fit, name);
    return CandidateOutcome::also_fits_with_more_unknowns;
  }
  add_once(step.tied_with, name);
  return CandidateOutcome::tied;
}

Step make_step(const AcceptanceOptions& options, const Model& before, Ranked& winner,
               const std::vector<Ranked*>& good) {
  Step step = step_of(before, winner, {});
  winner.outcome = CandidateOutcome::named;
  for (auto* r : good) {
    if (r != &winner) r->outcome = compare(options, *r, winner, step);
  }
  // The same effect in another place or form is no rival.
  std::erase(step.tied_with, std::string(winner.effect->name()));
  return step;
}

}  // namespace

CandidateOutcome too_little_of(const AcceptanceOptions& options, const Effect& effect, std::size_t unknowns,
                               const Gain& gain, double first_gap) {
  if (!(gain.share >= options.min_gain)) return CandidateOutcome::no_gain_on_folds;
  const bool plain = unknowns <= options.few_plain_unknowns && gain.z > options.plain_significance;
  const double for_unknowns = plain ? 0.0 : options.min_part_each * static_cast<double>(unknowns - 1);
  const double min_part = std::min(options.max_min_part, options.min_part_of_gap + for_unknowns);
  const bool takes_most = plain && gain.share > options.most_of_rest;
  if (!takes_most && gain.explained < min_part * first_gap) return CandidateOutcome::no_gain_on_folds;
  return gain.z >= options.needed_significance(effect) ? CandidateOutcome::not_judged
                                                       : CandidateOutcome::not_significant;
}

bool as_good_on_folds(const AcceptanceOptions& options, const LeftOnFolds& one, const LeftOnFolds& than,
                      double surely) {
  const double worse = one.rms / than.rms - 1.0;
  return worse < surely || hardly_worse(options, worse, one.residuals, than.residuals);
}

double gap_to_explain(const SearchSetting& setting, const SearchRecords& records, const Model& model) {
  const auto& terms = model.terms();
  const bool no_form = std::all_of(terms.begin(), terms.end(), [](const Term& term) {
    return term.effect->adds_one_signal() || term.effect->independent_of_input();
  });
  return no_form ? rms_of(model, records.train) : setting.first_gap;
}

Judgement judge(const SearchSetting& setting, const SearchRecords& records, const Model& before,
                std::vector<Ranked> ranking) {
  const auto& options = setting.options.acceptance;
  const auto residuals = round_residuals(before, records);
  Bar bar{rms(residuals.folds), 0.0};
  if (!before.terms().empty()) bar.first_gap = gap_to_explain(setting, records, before);
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const Ranked& a, const Ranked& b) { return a.folds_rms < b.folds_rms; });
  std::vector<Ranked*> good;
  for (auto& r : ranking) {
    r.outcome = objection_to(options, r, bar);
    if (r.outcome == CandidateOutcome::not_judged) good.push_back(&r);
  }
  if (!good.empty()) {
    Ranked* winner = nearest_at_hand(options, good, most_evident(records, good));
    Step step = make_step(options, before, *winner, good);
    step.ranking = ranking;
    return {std::move(step), std::move(ranking)};
  }
  return {std::nullopt, std::move(ranking)};
}

}  // namespace bodesmith::gap
