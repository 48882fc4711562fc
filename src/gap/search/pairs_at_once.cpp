#include "gap/search/pairs_at_once.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/round.hpp"
#include "gap/search/step.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

const Effect* effect_of(const Promising& p) {
  return p.proposal.model.terms().back().effect;
}

/// What two names leave is all but the same: one can stand for the other.
bool are_alike(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kAlike = 0.97;
  double ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) ab += a[i] * b[i];
  return ab > kAlike * rms(a) * rms(b) * static_cast<double>(a.size());
}

/// The best of every effect in the round that can be fitted and leaves less than before; of those that leave the same (many lags)
/// the best few.
std::vector<const Ranked*> firsts_among(const SearchSetting& setting, const SearchRecords& records,
                                        const std::vector<Ranked>& ranking, double left_before) {
  const auto& options = setting.options;
  std::vector<const Ranked*> sorted;
  for (const auto& r : ranking) {
    if (r.condition_number > options.acceptance.max_condition || r.unknowns > options.acceptance.max_unknowns)
      continue;
    if (r.train_rms < options.pairs.max_left_train * left_before || r.effect->adds_one_signal())
      sorted.push_back(&r);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Ranked* a, const Ranked* b) { return a->train_rms < b->train_rms; });
  std::vector<const Ranked*> firsts;
  std::vector<std::vector<double>> left;
  std::set<const Effect*> effects;
  for (const auto* r : sorted) {
    if (firsts.size() >= options.pairs.firsts_at_once) break;
    if (effects.count(r->effect) != 0) continue;
    auto residuals = residuals_of(r->model, records.train);
    const auto alike = static_cast<std::size_t>(std::count_if(
        left.begin(), left.end(), [&](const auto& other) { return are_alike(residuals, other); }));
    if (alike >= options.pairs.alike_at_once) continue;
    effects.insert(r->effect);
    firsts.push_back(r);
    left.push_back(std::move(residuals));
  }
  return firsts;
}

/// What the looks beside all first names promise, best first: of each some effects at their best places.
std::vector<Promising> seconds_beside(const SearchSetting& setting, const SearchRecords& records,
                                      const std::vector<const Ranked*>& firsts) {
  const auto& options = setting.options;
  std::vector<std::pair<double, Promising>> all;
  for (const auto* first : firsts) {
    if (options.is_late()) break;
    const double left = rms_of(first->model, records.look());
    std::set<const Effect*> effects;
    for (auto& second : look_round(setting, records, first->model)) {
      if (second.z < options.round.min_promise || !effects.insert(effect_of(second)).second) continue;
      all.emplace_back(left * std::sqrt(std::max(0.0, 1.0 - second.score)), std::move(second));
      if (effects.size() >= options.pairs.seconds_at_once) break;
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (all.size() > options.pairs.fits_at_once) all.resize(options.pairs.fits_at_once);
  std::vector<Promising> seconds;
  for (auto& each : all) seconds.push_back(std::move(each.second));
  return seconds;
}

/// The first name beside which a pair's second one was fitted.
const Ranked& first_of(const std::vector<const Ranked*>& firsts, const Ranked& pair) {
  const auto& terms = pair.model.terms();
  return **std::find_if(firsts.begin(), firsts.end(),
                        [&](const Ranked* r) { return r->effect == terms[terms.size() - 2].effect; });
}

}  // namespace

std::vector<std::pair<Step, Step>> pairs_at_once(const SearchSetting& setting, const SearchRecords& records,
                                                 const Model& before, const std::vector<Ranked>& ranking) {
  const auto& options = setting.options;
  const double left_before = rms_of(before, records.train);
  const auto firsts = firsts_among(setting, records, ranking, left_before);
  const auto seconds = seconds_beside(setting, records, firsts);
  if (seconds.empty() || options.is_late()) return {};
  const auto fitted = fit_chosen(setting, records, before, seconds);
  const double enough = (1.0 - options.pairs.min_gains * options.acceptance.min_gain) * left_before;
  std::vector<std::pair<Step, Step>> pairs;
  std::set<std::set<const Effect*>> names;
  for (const auto& r : fitted) {
    if (!(r.train_rms < enough) || pairs.size() >= options.pairs.best_at_once) break;
    const Ranked& alone = first_of(firsts, r);
    if (r.no_name || !names.insert({alone.effect, r.effect}).second) continue;
    Step first = step_of(before, alone, ranking, CandidateOutcome::named_in_pair);
    Step second = step_of(alone.model, r, fitted, CandidateOutcome::named_in_pair);
    first.pair_with = second.effect->name();
    second.pair_with = first.effect->name();
    pairs.emplace_back(std::move(first), std::move(second));
  }
  return pairs;
}

}  // namespace bodesmith::gap
