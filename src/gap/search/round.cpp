#include "gap/search/round.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "gap/evidence/score.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/signs/chance.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Share of the residual's energy that a proposal must promise to be fitted: half of what it must take in the end.
constexpr double kLeastPromise = kLeastShare / 2.0;

/// Twice the same is one term with more freedom than it says.
bool repeats_earlier_term(const Proposal& proposal, bool in_response) {
  const auto& terms = proposal.model.terms();
  const auto* effect = terms.back().effect;
  if (effect->facts().may_repeat(in_response)) return false;
  return std::any_of(terms.begin(), terms.end() - 1,
                     [&](const Term& earlier) { return earlier.effect == effect; });
}

/// The best places of each of the best effects.
std::vector<Promising> best_of(std::vector<Promising> promising) {
  std::map<const Effect*, std::size_t> places;
  std::erase_if(promising, [&](const Promising& p) {
    const auto* effect = p.proposal.term().effect;
    const bool full = places.size() >= kEffectsOfRound && places.count(effect) == 0;
    return p.score < kLeastPromise || full || ++places[effect] > kFew;
  });
  return promising;
}

/// Fits the leaders, whose fits saw only stretches, on the whole records.
void fit_leaders_on_all(const SearchSetting& setting, const SearchRecords& records,
                        std::vector<Ranked>& ranking) {
  const auto& options = setting.options;
  const std::size_t leaders = std::min(kFew, ranking.size());
  parallel_for(leaders, allowed_threads(), [&](std::size_t i) {
    if (options.is_late()) return;
    auto fitted = fit(ranking[i].model, records.train, few_steps(options));
    if (!fitted.usable()) return;
    ranking[i].model = std::move(fitted.model);
    ranking[i].train_rms = rms_of(ranking[i].model, records.train);
  });
}

/// What each is called beforehand, and the evidence of all but those far behind the best that is a name.
void weigh(const SearchRecords& records, std::vector<Ranked>& ranking) {
  parallel_for(ranking.size(), allowed_threads(), [&](std::size_t i) {
    auto& r = ranking[i];
    const std::size_t last = r.model.terms().size() - 1;
    Model without = r.model;
    without.remove(last);
    const auto scene = make_scene(without, records.train);
    if (r.effect->is_no_name(r.model, r.model.terms().back(), scene)) r.outcome = CandidateOutcome::no_name;
    // Values that are usually another effect's traces: as seldom as a sign by chance.
    if (r.effect->is_implausible(r.model))
      r.model.set_log_prior(last, r.model.terms().back().log_prior - kLogDeviations);
  });
  double best = std::numeric_limits<double>::infinity();
  for (const auto& r : ranking) {
    if (r.outcome != CandidateOutcome::no_name) best = std::min(best, r.train_rms);
  }
  parallel_for(ranking.size(), allowed_threads(), [&](std::size_t i) {
    auto& r = ranking[i];
    if (r.outcome != CandidateOutcome::no_name && r.train_rms <= kFarMore * best)
      r.log_evidence = log_evidence(r.model, records.train);
  });
}

/// The candidates that could be fitted, best first.
std::vector<Ranked> rank(const SearchSetting& setting, const SearchRecords& records,
                         std::vector<std::optional<Ranked>> fitted) {
  std::vector<Ranked> ranking;
  for (auto& r : fitted) {
    if (r) ranking.push_back(std::move(*r));
  }
  const auto by_rms = [](const Ranked& a, const Ranked& b) { return a.train_rms < b.train_rms; };
  std::stable_sort(ranking.begin(), ranking.end(), by_rms);
  if (records.are_long()) {
    fit_leaders_on_all(setting, records, ranking);
    std::stable_sort(ranking.begin(), ranking.end(), by_rms);
  }
  if (ranking.empty()) return ranking;
  weigh(records, ranking);
  std::stable_sort(ranking.begin(), ranking.end(), more_evident);
  return ranking;
}

}  // namespace

std::vector<Promising> look_round(const SearchRecords& records, const Model& model) {
  const auto scene = make_scene(model, records.train);
  std::vector<const Effect*> effects;
  for (const auto* effect : effect_registry().all()) {
    if (!scene.frequency_only || effect->facts().linear) effects.push_back(effect);
  }
  std::vector<std::vector<Proposal>> of_each(effects.size());
  parallel_for(effects.size(), allowed_threads(),
               [&](std::size_t i) { effects[i]->propose(scene, of_each[i]); });
  std::vector<Proposal> proposals;
  for (auto& own : of_each) std::move(own.begin(), own.end(), std::back_inserter(proposals));
  std::erase_if(proposals, [&](const Proposal& p) { return repeats_earlier_term(p, scene.frequency_only); });
  std::map<const Effect*, std::size_t> places;
  for (const auto& p : proposals) ++places[p.term().effect];
  auto promising = shortlist(model, std::move(proposals), records.look());
  for (auto& p : promising) p.places = places[p.proposal.term().effect];
  return promising;
}

FittedRound fit_round(const SearchSetting& setting, const SearchRecords& records, const Model& model) {
  const auto& options = setting.options;
  FittedRound round;
  const auto chosen = best_of(look_round(records, model));
  if (options.stopped()) return {};
  auto fitted = fit_candidates(setting, records, chosen);
  std::set<std::string_view> missed;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    if (!fitted[i] && options.is_late()) missed.insert(chosen[i].proposal.term().effect->name());
  }
  round.not_tried.assign(missed.begin(), missed.end());
  round.ranking = rank(setting, records, std::move(fitted));
  return round;
}

std::vector<Ranked> fit_chosen(const SearchSetting& setting, const SearchRecords& records,
                               const std::vector<Promising>& chosen) {
  return rank(setting, records, fit_candidates(setting, records, chosen));
}

}  // namespace bodesmith::gap
