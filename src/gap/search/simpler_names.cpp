#include "gap/search/simpler_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "gap/runner.hpp"
#include "gap/search/acceptance.hpp"
#include "gap/search/backward_elimination.hpp"
#include "gap/search/base_fit.hpp"
#include "gap/search/folds.hpp"
#include "gap/search/grow.hpp"
#include "gap/search/round.hpp"
#include "gap/search/step.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Terms with so many unknowns are families: they fit what they are not.
constexpr std::size_t kFamily = 5;
/// Names of which each is tried beside them.
constexpr std::size_t kNamesBeside = 2;
/// Weights of a bank that rest at 0 vary: so many more in use make no name less simple.
constexpr std::size_t kMoreInUse = 2;

/// Unknowns of the names, and those of them that do not rest at a bound.
struct Size {
  std::size_t unknowns = 0;
  std::size_t effective = 0;
};

/// Names in the place of one.
struct Instead {
  std::vector<Step> steps;
  Size size;
  double folds_rms = 0.0;
};

/// What they are compared with.
struct Family {
  const Effect* effect;
  Size size;
  Folds kind;
  std::vector<double> folds;  ///< residuals of the model with it
  double folds_rms;
};

/// Plainly less left, with hardly more unknowns in use. As little is not enough: a pair of names can be bent to what
/// asymmetric memory leaves, too.
bool is_better_than(const SearchSetting& setting, const SearchRecords& records, const Family& family,
                    const Model& model, Size size) {
  const auto& options = setting.options;
  if (size.effective > family.size.effective + kMoreInUse) return false;
  const auto folds = folded_residuals(model, records.train, family.kind);
  if (folds.size() != family.folds.size()) return false;
  return rms(folds) < options.elimination.swap_gain * family.folds_rms &&
         improvement_z(family.folds, folds) > options.acceptance.tie_significance;
}

bool is_possible(const AcceptanceOptions& options, const Ranked& r) {
  return !r.no_name && r.condition_number <= options.max_condition && r.unknowns <= options.max_unknowns;
}

/// What the family explains beside its relative hides that one: a relative need promise nothing.
std::vector<Ranked> relatives_of(const SearchSetting& setting, const SearchRecords& records,
                                 const Effect& family, const Model& model) {
  const auto is_relative = [&](const Effect& effect) { return is_confused_with(family, effect); };
  auto ranking = fit_whatever_is_promised(setting, records, model, is_relative);
  std::erase_if(ranking, [&](const Ranked& r) { return !is_possible(setting.options.acceptance, r); });
  return ranking;
}

bool earns_its_place(const AcceptanceOptions& options, const Ranked& r, double left_before) {
  return r.folds_rms < (1.0 - options.min_gain) * left_before &&
         r.least_z() >= options.needed_significance(*r.effect);
}

/// Names that are neither the family's nor its relatives', where it is not there: the one that a round would name, and
/// those that would do with fewer unknowns. `relative`: found beside it, and then without it.
std::vector<Step> names_beside(const SearchSetting& setting, const SearchRecords& records,
                               const Family& family, const Model& without, const Ranked* relative) {
  const Model& from = relative != nullptr ? relative->model : without;
  auto judged = judge(setting, records, from, fit_round(setting, records, from, [&](const Effect& effect) {
                                                return &effect != family.effect &&
                                                       !is_confused_with(*family.effect, effect);
                                              }).ranking);
  std::vector<Step> steps;
  if (!judged.step) return steps;
  const std::size_t most = judged.step->after.terms().back().unknowns.size();
  std::set<const Effect*> names = {judged.step->effect};
  steps.push_back(std::move(*judged.step));
  for (const auto& r : judged.ranking) {
    const bool would_do = r.outcome == CandidateOutcome::tied || r.outcome == CandidateOutcome::worse;
    if (steps.size() >= kNamesBeside || !would_do || r.unknowns >= most) continue;
    if (names.insert(r.effect).second) steps.push_back(step_of(from, r, judged.ranking));
  }
  if (relative == nullptr) return steps;
  for (auto& step : steps) {
    step.before = without;
    step.after = without_term(setting, records, step.after, from.terms().size() - 1).model;
  }
  return steps;
}

/// One more name, and the relative that then fits best beside it: where both together are better than the family and each
/// earns its place.
std::optional<Instead> with_one_more(const SearchSetting& setting, const SearchRecords& records,
                                     const Family& family, const Step& one) {
  const auto& accepted = setting.options.acceptance;
  const auto ranking = relatives_of(setting, records, *family.effect, one.after);
  const double left_by_one = rms(round_residuals(one.after, records).folds);
  std::optional<Instead> best;
  for (const auto& r : ranking) {
    if (best && r.folds_rms >= best->folds_rms) continue;
    const auto& terms = r.model.terms();
    const auto& other = terms[terms.size() - 2];
    const Size size{r.unknowns + other.unknowns.size(), r.effective + other.effective_unknowns()};
    if (!is_better_than(setting, records, family, r.model, size)) continue;
    if (!earns_its_place(accepted, r, left_by_one)) continue;
    const auto own = without_term(setting, records, r.model, terms.size() - 2).gain;
    if (own.share < accepted.min_gain || own.z < accepted.min_significance) continue;
    best = Instead{{one, step_of(one.after, r, ranking)}, size, r.folds_rms};
  }
  return best;
}

/// Names in the place of term `k`: a relative alone, the one with the fewest unknowns; or the pair that leaves least.
std::optional<Instead> instead_of(const SearchSetting& setting, const State& state, std::size_t k) {
  const auto& records = state.records;
  const auto& model = state.found.model;
  const auto& term = model.terms()[k];
  const Model without = without_term(setting, records, model, k).model;
  const auto kind = suitable_folds(without, records.train);
  auto folds = folded_residuals(model, records.train, kind);
  const double left = rms(folds);
  const Family family{
      term.effect, {term.unknowns.size(), term.effective_unknowns()}, kind, std::move(folds), left};
  const auto ranking = relatives_of(setting, records, *family.effect, without);
  const double left_without = rms(folded_residuals(without, records.train, kind));
  std::optional<Instead> best;
  for (const auto& r : ranking) {
    const Size size{r.unknowns, r.effective};
    if (best && best->size.unknowns <= r.unknowns) continue;
    if (earns_its_place(setting.options.acceptance, r, left_without) &&
        is_better_than(setting, records, family, r.model, size))
      best = Instead{{step_of(without, r, ranking)}, size, r.folds_rms};
  }
  if (best) return best;
  // Beside what stands without the family, and beside its best relative: one may hide the other.
  std::vector<const Ranked*> beside = {nullptr};
  if (!ranking.empty() && ranking.front().unknowns < family.size.unknowns) beside.push_back(&ranking.front());
  for (const auto* relative : beside) {
    for (const auto& one : names_beside(setting, records, family, without, relative)) {
      if (best || setting.options.is_late()) return best;
      best = with_one_more(setting, records, family, one);
    }
  }
  return best;
}

}  // namespace

void try_simpler_names(const SearchSetting& setting, State& state) {
  if (are_responses(state.records.train)) return;
  for (std::size_t k = 0; k < state.found.steps.size() && k < state.found.model.terms().size(); ++k) {
    if (setting.options.is_late()) return;
    if (state.found.model.terms()[k].effective_unknowns() < kFamily) continue;
    auto instead = instead_of(setting, state, k);
    if (!instead) continue;
    State other = state;
    std::vector<std::string> names;
    for (const auto& step : instead->steps) names.emplace_back(step.effect->name());
    other.found.notes.push_back(fmt::format("{} took the place of {}: less is left with simpler names",
                                            join(names, " and "), state.found.steps[k].effect->name()));
    // Terms keep the order of the steps: the new ones are the last.
    other.found.steps.erase(other.found.steps.begin() + static_cast<std::ptrdiff_t>(k));
    for (auto& step : instead->steps) other.found.steps.push_back(std::move(step));
    other.found.model = settle(setting, other.records, other.found.steps.back().after);
    other.other_way = true;
    grow(setting, other);
    state = std::move(other);
    return;
  }
}

}  // namespace bodesmith::gap
