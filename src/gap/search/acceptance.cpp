#include "gap/search/acceptance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
  double train_rms = 0.0;
  double first_gap = 0.0;  ///< gap_to_explain(); 0: this is the first term
};

/// What speaks against a candidate on its own; not_judged: nothing.
CandidateOutcome objection_to(const AcceptanceOptions& options, const Ranked& r, const Bar& bar) {
  const double gain = 1.0 - r.folds_rms / bar.folds_rms;
  if (!(gain >= options.min_gain)) return CandidateOutcome::no_gain_on_folds;
  const double explained =
      std::sqrt(std::max(0.0, bar.folds_rms * bar.folds_rms - r.folds_rms * r.folds_rms));
  const bool plain = r.unknowns <= options.few_plain_unknowns && r.least_z() > options.plain_significance;
  const double for_unknowns = plain ? 0.0 : options.min_part_each * static_cast<double>(r.unknowns - 1);
  const double min_part = std::min(options.max_min_part, options.min_part_of_gap + for_unknowns);
  const bool takes_most = plain && gain > options.most_of_rest;
  if (!takes_most && explained < min_part * bar.first_gap) return CandidateOutcome::no_gain_on_folds;
  if (!(r.least_z() >= options.needed_significance(*r.effect))) return CandidateOutcome::not_significant;
  if (r.unknowns > options.max_unknowns) return CandidateOutcome::too_free;
  if (r.condition_number > options.max_condition) return CandidateOutcome::ill_conditioned;
  if (r.no_name) return CandidateOutcome::no_name;
  const auto& unknowns = r.model.terms().back().unknowns;
  const bool at_bound =
      unknowns.size() <= options.few_unknowns &&
      std::any_of(unknowns.begin(), unknowns.end(), [](const Unknown& u) { return u.at_bound(); });
  if (at_bound && gain < options.min_gain_at_bound) return CandidateOutcome::at_end_of_range;
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

/// Fewer unknowns in use, or as many where one of the few that the other has rests at a bound: a shape that only fits at the
/// end of its range is another's.
bool is_simpler(const AcceptanceOptions& options, const Ranked& r, const Ranked& than) {
  if (r.effective != than.effective) return r.effective < than.effective;
  return than.unknowns <= options.few_unknowns && r.unknowns < than.unknowns;
}

/// The first of the good candidates, unless more unknowns buy next to nothing: then one with fewer of them.
Ranked* simplest_of_best(const AcceptanceOptions& options, const std::vector<Ranked*>& good) {
  const Ranked& best = *good.front();
  Ranked* winner = good.front();
  for (auto* r : good) {
    if (!is_simpler(options, *r, *winner)) continue;
    // Weights that rest at 0 make no other form of a bank simpler than another.
    if (r->effect == winner->effect && r->unknowns == winner->unknowns) continue;
    const double worse = r->folds_rms / best.folds_rms - 1.0;
    const auto fewer = static_cast<double>(best.effective - r->effective);
    const bool next_to_nothing = worse < options.simpler_within + options.simpler_within_each * fewer;
    // On folds the model's own unknowns may count for more than the term's: one record alone need not tell them.
    const bool nearer_on_all = r->train_rms <= best.train_rms;
    if (next_to_nothing || r->train_rms < options.far_nearer_on_all * best.train_rms ||
        (worse < options.tie_within && nearer_on_all) || hardly_worse(options, worse, r->folds, best.folds))
      winner = r;
  }
  return winner;
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

Step make_step(const AcceptanceOptions& options, const Model& before, Ranked& winner, double control,
               const std::vector<Ranked*>& good) {
  Step step = step_of(before, winner, {});
  step.control_gain = control;
  winner.outcome = CandidateOutcome::named;
  for (auto* r : good) {
    if (r != &winner) r->outcome = compare(options, *r, winner, step);
  }
  // The same effect in another place or form is no rival.
  std::erase(step.tied_with, std::string(winner.effect->name()));
  return step;
}

}  // namespace

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
  Bar bar{rms(residuals.folds), rms(residuals.train), 0.0};
  if (!before.terms().empty()) bar.first_gap = gap_to_explain(setting, records, before);
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const Ranked& a, const Ranked& b) { return a.folds_rms < b.folds_rms; });
  std::vector<Ranked*> good;
  for (auto& r : ranking) {
    r.outcome = objection_to(options, r, bar);
    if (r.outcome == CandidateOutcome::not_judged) good.push_back(&r);
  }
  while (!good.empty()) {
    Ranked* winner = nearest_at_hand(options, good, simplest_of_best(options, good));
    const bool sure = winner->least_z() > options.sure || setting.options.is_late();
    const double control = sure ? 0.0 : control_gain(setting, records, before, *winner);
    const double gain = 1.0 - winner->folds_rms / bar.folds_rms;
    if (gain < options.control_factor * control) {
      winner->outcome = CandidateOutcome::no_more_than_control;
      std::erase(good, winner);
      continue;
    }
    Step step = make_step(options, before, *winner, control, good);
    step.ranking = ranking;
    return {std::move(step), std::move(ranking)};
  }
  return {std::nullopt, std::move(ranking)};
}

}  // namespace bodesmith::gap
