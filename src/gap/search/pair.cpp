#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/acceptance.hpp"
#include "gap/search/backward_elimination.hpp"
#include "gap/search/round.hpp"
#include "gap/search/step.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Candidates worth a trial, most promising first.
std::vector<const Ranked*> trials_among(const SearchOptions& options, const std::vector<Ranked>& ranking,
                                        double folds_before) {
  std::vector<const Ranked*> trials;
  for (const auto& r : ranking) {
    if (r.condition_number > options.acceptance.max_condition || r.unknowns > options.acceptance.max_unknowns)
      continue;
    if (r.no_name) continue;
    if (r.folds_rms < options.pairs.max_left * folds_before) trials.push_back(&r);
  }
  std::stable_sort(trials.begin(), trials.end(),
                   [](const Ranked* a, const Ranked* b) { return a->folds_rms < b->folds_rms; });
  return trials;
}

/// A second term that earns its place beside the first candidate's, when that one then earns its own and both
/// gain enough.
std::optional<Step> second_beside(const SearchSetting& setting, const SearchRecords& records,
                                  const Ranked& first, double rms_before) {
  const auto& options = setting.options;
  auto ranking = fit_round(setting, records, first.model).ranking;
  if (options.is_late() || ranking.empty()) return std::nullopt;
  auto second = judge(setting, records, first.model, std::move(ranking)).step;
  if (!second) return std::nullopt;
  if (!without_term(setting, records, second->after, first.model.terms().size() - 1).earns_its_place)
    return std::nullopt;
  const double enough = (1.0 - options.pairs.min_gains * options.acceptance.min_gain) * rms_before;
  if (!(rms_of(second->after, records.train) < enough)) return std::nullopt;
  return second;
}

/// The two as steps, and why they stand together.
Pair pair_of(const Model& before, const std::vector<Ranked>& ranking, const Ranked& first, Step second) {
  Step step = step_of(before, first, ranking, CandidateOutcome::named_in_pair);
  step.pair_with = second.effect->name();
  second.pair_with = first.effect->name();
  for (auto& r : second.ranking) {
    if (r.outcome == CandidateOutcome::named) r.outcome = CandidateOutcome::named_in_pair;
  }
  auto note =
      fmt::format("{} and {} earn their places only together", first.effect->name(), second.effect->name());
  return {std::move(step), std::move(second), std::move(note)};
}

}  // namespace

std::optional<Pair> choose_pair(const SearchSetting& setting, const SearchRecords& records,
                                const Model& before, const std::vector<Ranked>& ranking) {
  const auto& options = setting.options;
  const auto residuals = round_residuals(before, records);
  std::set<const Effect*> tried;
  for (const auto* first : trials_among(options, ranking, rms(residuals.folds))) {
    if (options.is_late() || tried.size() >= options.pairs.trials) break;
    if (!tried.insert(first->effect).second) continue;
    if (auto second = second_beside(setting, records, *first, rms(residuals.train)))
      return pair_of(before, ranking, *first, std::move(*second));
  }
  return std::nullopt;
}

}  // namespace bodesmith::gap
