#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/acceptance.hpp"
#include "gap/search/backward_elimination.hpp"
#include "gap/search/round.hpp"

namespace bodesmith::gap {
namespace {

/// Candidates worth a trial, most promising first.
std::vector<const Ranked*> trials_among(const SearchOptions& options, const std::vector<Ranked>& ranking,
                                        double train_before, double holdout_before) {
  const auto left = [&](const Ranked& r) { return pooled_left(r, train_before, holdout_before); };
  std::vector<const Ranked*> trials;
  for (const auto& r : ranking) {
    if (r.condition_number > options.acceptance.max_condition || r.unknowns > options.acceptance.max_unknowns)
      continue;
    if (left(r) < options.pairs.max_left && r.train_rms < options.pairs.max_left_train * train_before)
      trials.push_back(&r);
  }
  std::stable_sort(trials.begin(), trials.end(),
                   [&](const Ranked* a, const Ranked* b) { return left(*a) < left(*b); });
  return trials;
}

/// A second term that earns its place beside the first candidate's, when that one then earns its own and both
/// gain enough.
std::optional<Step> second_beside(const SearchSetting& setting, const SearchRecords& records,
                                  const Ranked& first, double holdout_before) {
  const auto& options = setting.options;
  auto ranking = fit_round(setting, records, first.model);
  if (options.stopped()) return std::nullopt;
  auto second = judge(setting, records, first.model, std::move(ranking)).step;
  if (!second) return std::nullopt;
  const auto& accepted = options.acceptance;
  const auto own = without_term(setting, records, second->after, first.model.terms().size() - 1).gain;
  if (own.share < accepted.min_gain || !is_significant(accepted, own)) return std::nullopt;
  const double enough = (1.0 - options.pairs.min_gains * accepted.min_gain) * holdout_before;
  if (!(rms_of(second->after, records.holdout) < enough)) return std::nullopt;
  return second;
}

}  // namespace

std::optional<Pair> choose_pair(const SearchSetting& setting, const SearchRecords& records,
                                const Model& before, const std::vector<Ranked>& ranking) {
  const auto& options = setting.options;
  const double train_before = rms_of(before, records.train);
  const double holdout_before = rms_of(before, records.holdout);
  std::set<const Effect*> tried;
  for (const auto* first : trials_among(options, ranking, train_before, holdout_before)) {
    if (options.stopped() || tried.size() >= options.pairs.trials) break;
    if (!tried.insert(first->effect).second) continue;
    auto second = second_beside(setting, records, *first, holdout_before);
    if (!second) continue;
    Step step;
    step.effect = first->effect;
    step.placed = first->placed;
    step.before = before;
    step.after = first->model;
    step.ranking = ranking;
    auto note = fmt::format("{} and {} earn their places only together", first->effect->name(),
                            second->effect->name());
    return Pair{std::move(step), std::move(*second), std::move(note)};
  }
  return std::nullopt;
}

}  // namespace bodesmith::gap
