#include "gap/search/backward_elimination.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/folds.hpp"
#include "gap/search/round.hpp"
#include "gap/search/step.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Iterations of the refit without a term.
constexpr int kIterationsWithout = 12;

Model refitted_without(const SearchSetting& setting, const SearchRecords& records, Model model,
                       std::size_t term) {
  model.remove(term);
  return fit_in_turn(setting, records, std::move(model), kIterationsWithout).model;
}

/// The earlier terms, those with the most unknowns in use first: they can take over what simpler ones explain.
std::vector<std::size_t> by_unknowns(const Found& found) {
  const auto& terms = found.model.terms();
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k + 1 < std::min(found.steps.size(), terms.size()); ++k) order.push_back(k);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return terms[a].effective_unknowns() > terms[b].effective_unknowns();
  });
  return order;
}

/// Takes out the first of the earlier terms that no longer earns its place. Whether there was one.
bool prune_one(const SearchSetting& setting, const SearchRecords& records, Found& found) {
  for (const std::size_t k : by_unknowns(found)) {
    auto without = without_term(setting, records, found.model, k);
    if (without.earns_its_place) continue;
    found.notes.push_back(fmt::format("{} was taken out again: a later term explains what it did",
                                      found.model.terms()[k].effect->name()));
    found.model = std::move(without.model);
    found.steps.erase(found.steps.begin() + static_cast<std::ptrdiff_t>(k));
    return true;
  }
  return false;
}

/// Takes out earlier terms that no longer earn their place.
Found prune(const SearchSetting& setting, const SearchRecords& records, Found found) {
  while (prune_one(setting, records, found)) {
  }
  return found;
}

/// Effects that may do better than the step's once later terms are there: its ties, and those that were not
/// far worse.
std::set<const Effect*> rivals_of(const SearchSetting& setting, const SearchRecords& records,
                                  const Step& step) {
  const auto& options = setting.options.elimination;
  std::set<const Effect*> rivals;
  for (const auto& name : step.tied_with) rivals.insert(&effect_registry().get(name));
  const double own = rms_of(step.after, records.train);
  for (const auto& r : step.ranking) {
    if (r.effect != step.effect && rivals.size() < options.max_rivals &&
        r.train_rms < options.far_worse * own)
      rivals.insert(r.effect);
  }
  return rivals;
}

/// Whether the term's present values lie where another effect is the usual cause: as a ranking that holds its effect too says,
/// otherwise its own round's.
bool is_far_fetched_now(const Effect* effect, const std::vector<Ranked>& ranking,
                        const std::vector<Ranked>& own_round) {
  for (const auto* where : {&ranking, &own_round}) {
    const auto own = std::find_if(where->begin(), where->end(),
                                  [&](const Ranked& r) { return r.effect == effect && !r.folds.empty(); });
    if (own != where->end()) return own->far_fetched;
  }
  return false;
}

/// What the present model leaves, on folds and of all records.
struct LeftNow {
  std::vector<double> folds;
  double train_rms = 0.0;
};

/// The candidate that best takes the place of a term of the present model, the simplest of those that do it as well; null when
/// none does.
const Ranked* best_successor(const SearchSetting& setting, const LeftNow& now, const Term& term,
                             const std::vector<Ranked>& ranking, bool far_fetched) {
  const auto& accepted = setting.options.acceptance;
  const auto& options = setting.options.elimination;
  const double folds = rms(now.folds);
  const double train = now.train_rms;
  std::vector<const Ranked*> good;
  for (const auto& r : ranking) {
    if (r.no_name || r.condition_number > accepted.max_condition || r.unknowns > accepted.max_unknowns)
      continue;
    // A rival of many unknowns takes in what the other terms leave of their own shares; on folds those of them that rest at a
    // bound stay there, which is no merit: it must leave as much less on all records, too.
    const std::size_t more = r.effective - std::min(r.effective, term.effective_unknowns());
    const double enough = options.swap_gain - options.swap_gain_each * static_cast<double>(more);
    const bool better = r.folds_rms < enough * folds && (more == 0 || r.train_rms < enough * train);
    // On folds the model's own unknowns may count for more than the term's: one record alone need not tell them.
    const bool as_near = r.folds_rms < (1.0 + accepted.tie_within) * folds &&
                         r.train_rms < (1.0 + accepted.tie_surely_within) * train;
    const bool simpler =
        r.effective < term.effective_unknowns() && (as_near || r.folds_rms < options.swap_simpler * folds);
    const bool nearer = far_fetched && !r.far_fetched &&
                        r.effective <= term.effective_unknowns() + accepted.at_hand_more_unknowns &&
                        r.folds_rms < (1.0 + accepted.at_hand_within) * folds;
    if (better || simpler || nearer) good.push_back(&r);
  }
  if (good.empty()) return nullptr;
  const auto on_folds = [](const Ranked* a, const Ranked* b) { return a->folds_rms < b->folds_rms; };
  const double least = (*std::min_element(good.begin(), good.end(), on_folds))->folds_rms;
  std::erase_if(good, [&](const Ranked* r) { return r->folds_rms > options.swap_simpler * least; });
  return *std::min_element(good.begin(), good.end(), [&](const Ranked* a, const Ranked* b) {
    return a->effective != b->effective ? a->effective < b->effective : on_folds(a, b);
  });
}

/// Which rivals are as good a name for an earlier term now that the later ones are there. `folds`: residuals of
/// the present model.
void judge_ties_again(const AcceptanceOptions& options, Step& step, const Term& term,
                      const std::vector<double>& folds, const std::vector<Ranked>& ranking) {
  const double own = rms(folds);
  const bool far_fetched = is_far_fetched_now(step.effect, ranking, step.ranking);
  std::set<std::string> alike;
  for (const auto& r : ranking) {
    if (r.folds.size() != folds.size() || r.unknowns > term.unknowns.size()) continue;
    if (r.far_fetched && !far_fetched) continue;
    if (r.folds_rms < (1.0 + options.tie_within) * own &&
        improvement_z(r.folds, folds) < options.tie_significance)
      alike.insert(std::string(r.effect->name()));
  }
  alike.erase(std::string(step.effect->name()));
  step.tied_with.assign(alike.begin(), alike.end());
}

/// Everything that may stand in the place of `effect`: what the look promises most of, and what is confused with it.
std::vector<Ranked> successors_of(const SearchSetting& setting, const SearchRecords& records,
                                  const Effect& effect, const Model& without) {
  auto ranking = fit_round(setting, records, without).ranking;
  std::set<const Effect*> done;
  for (const auto& r : ranking) done.insert(r.effect);
  auto relatives = fit_round(setting, records, without, [&](const Effect& other) {
                     return done.count(&other) == 0 &&
                            (is_confused_with(effect, other) || is_confused_with(other, effect));
                   }).ranking;
  std::move(relatives.begin(), relatives.end(), std::back_inserter(ranking));
  return ranking;
}

/// What is found with term `k` exchanged for the best that can stand in its place; nothing when none does better: then its ties
/// are judged again. `without`: the model without it; `rivals`: empty, all that may.
std::optional<Found> with_exchanged(const SearchSetting& setting, const SearchRecords& records, Found& found,
                                    std::size_t k, const Model& without, const EffectFilter& rivals) {
  const Effect& own = *found.model.terms()[k].effect;
  auto ranking = rivals ? fit_round(setting, records, without, rivals).ranking
                        : successors_of(setting, records, own, without);
  const bool far_fetched = is_far_fetched_now(found.steps[k].effect, ranking, {});
  // On the folds of those that are compared with it.
  const LeftNow now{folded_residuals(found.model, records.train, suitable_folds(without, records.train)),
                    rms_of(found.model, records.train)};
  const Ranked* best = best_successor(setting, now, found.model.terms()[k], ranking, far_fetched);
  if (best == nullptr) {
    judge_ties_again(setting.options.acceptance, found.steps[k], found.model.terms()[k], now.folds, ranking);
    return std::nullopt;
  }
  Found exchanged = found;
  const auto* gone = found.steps[k].effect;
  if (best->effect != gone)
    exchanged.notes.push_back(fmt::format("{} took the place of {} once the other terms were there",
                                          best->effect->name(), gone->name()));
  exchanged.model = best->model;
  // Terms keep the order of the steps: the new one is the last.
  exchanged.steps.erase(exchanged.steps.begin() + static_cast<std::ptrdiff_t>(k));
  exchanged.steps.push_back(step_of(without, *best, ranking));
  return exchanged;
}

/// What is found with one earlier term exchanged; nothing when none of them should be.
std::optional<Found> with_one_exchanged(const SearchSetting& setting, const SearchRecords& records,
                                        Found& found) {
  for (std::size_t k = 0; k + 1 < found.steps.size(); ++k) {
    if (setting.options.is_late()) break;
    const auto rivals = rivals_of(setting, records, found.steps[k]);
    if (rivals.empty()) continue;
    auto exchanged =
        with_exchanged(setting, records, found, k, refitted_without(setting, records, found.model, k),
                       [&](const Effect& effect) { return rivals.count(&effect) != 0; });
    if (exchanged) return exchanged;
  }
  return std::nullopt;
}

}  // namespace

WithoutTerm without_term(const SearchSetting& setting, const SearchRecords& records, const Model& with,
                         std::size_t term) {
  constexpr double kIndispensable = 1e9;  // the model cannot be run without it
  WithoutTerm without{refitted_without(setting, records, with, term), {1.0, kIndispensable, kIndispensable}};
  const auto left = round_residuals(without.model, records);
  if (left.folds.empty()) return without;
  const auto folds = folded_residuals(with, records.train, left.kind);
  const Term& own = with.terms()[term];
  // Where one record leaves the model's own values open, folds are told apart by those: a name takes its share of all records.
  const double before = std::max(rms(left.train), 1e-300);
  const double on_folds = rms(folds) / std::max(rms(left.folds), 1e-300);
  const double on_all = rms_of(with, records.train) / before;
  without.gain.share = 1.0 - std::max(on_folds, on_all);
  without.gain.z = improvement_z(left.folds, folds);
  without.gain.explained = before * std::sqrt(std::max(0.0, 1.0 - on_all * on_all));
  const double gap = with.terms().size() > 1 ? gap_to_explain(setting, records, without.model) : 0.0;
  without.earns_its_place = too_little_of(setting.options.acceptance, *own.effect, own.unknowns.size(),
                                          without.gain, gap) == CandidateOutcome::not_judged;
  return without;
}

std::optional<Found> with_any_exchanged(const SearchSetting& setting, const SearchRecords& records,
                                        Found& found) {
  SearchOptions few = setting.options;
  few.round.effects = few.elimination.successors;
  const SearchSetting narrow{few, setting.initial, setting.first_gap};
  for (std::size_t k = 0; k < found.steps.size(); ++k) {
    if (setting.options.is_late()) break;
    // The others stay where they are: with a wrong one in its place they are nearer to the truth than alone.
    Model without = found.model;
    without.remove(k);
    auto exchanged = with_exchanged(narrow, records, found, k, without, {});
    if (exchanged) return prune(setting, records, std::move(*exchanged));
  }
  return std::nullopt;
}

Found test_earlier_terms(const SearchSetting& setting, const SearchRecords& records, Found found) {
  if (found.steps.size() < 2) return found;
  const std::size_t count = found.steps.size();
  found = prune(setting, records, std::move(found));
  const bool pruned = found.steps.size() < count;
  auto exchanged = with_one_exchanged(setting, records, found);
  if (exchanged) found = std::move(*exchanged);
  return exchanged || pruned ? prune(setting, records, std::move(found)) : found;
}

}  // namespace bodesmith::gap
