#include "gap/search/moves.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include "gap/evidence/names.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search/round.hpp"

namespace bodesmith::gap {
namespace {

/// First names for pairs: the best of every effect.
std::vector<Ranked> firsts_among(std::vector<Ranked> ranking) {
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const Ranked& a, const Ranked& b) { return a.train_rms < b.train_rms; });
  std::set<const Effect*> seen;
  std::erase_if(ranking, [&](const Ranked& r) {
    return r.outcome == CandidateOutcome::no_name || !seen.insert(r.effect).second;
  });
  if (ranking.size() > kEffectsOfRound) ranking.resize(kEffectsOfRound);
  return ranking;
}

/// What the looks alongside all first names promise, best first: of each every effect at its best place.
std::vector<Promising> second_names(const SearchSetting& setting, const SearchRecords& records,
                                    const std::vector<Ranked>& firsts) {
  const auto& options = setting.options;
  std::vector<std::pair<double, Promising>> all;
  for (const auto& first : firsts) {
    if (options.is_late()) break;
    const double left = rms_of(first.model, records.look());
    std::set<const Effect*> effects;
    for (auto& second : look_round(records, first.model)) {
      if (effects.insert(second.proposal.term().effect).second)
        all.emplace_back(left * std::sqrt(std::max(0.0, 1.0 - second.score)), std::move(second));
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (all.size() > 2 * kEffectsOfRound) all.resize(2 * kEffectsOfRound);
  std::vector<Promising> seconds;
  for (auto& each : all) seconds.push_back(std::move(each.second));
  return seconds;
}

}  // namespace

bool matters(const SearchSetting& setting, const SearchRecords& records, const Model& without,
             double rms_with) {
  const double before = rms_of(without, records.train);
  const double explained = std::sqrt(std::max(0.0, before * before - rms_with * rms_with));
  return explained >= kExplained * std::sqrt(before * setting.first_gap);
}

bool term_is_no_name(const Model& model, std::size_t term, const Experiments& train) {
  if (are_responses(train)) return false;
  const auto& own = model.terms()[term];
  return own.effect->is_no_name(model, own, make_scene(model, train));
}

const Ranked* best_of(const SearchSetting& setting, const SearchRecords& records, const Model& without,
                      std::vector<Ranked>& ranking) {
  std::map<const Effect*, double> held;
  for (auto& r : ranking) {
    if (!std::isfinite(r.log_evidence) || r.outcome == CandidateOutcome::no_name) continue;
    if (!matters(setting, records, without, r.train_rms)) {
      r.outcome = CandidateOutcome::takes_too_little;
      continue;
    }
    const auto [own, is_first] = held.emplace(r.effect, r.log_evidence);
    if (!is_first) own->second += std::log1p(std::exp(r.log_evidence - own->second));
  }
  // Greatest evidence first.
  const Ranked* winner = nullptr;
  for (const auto& r : ranking) {
    if (is_name(r) && (winner == nullptr || held[r.effect] > held[winner->effect])) winner = &r;
  }
  return winner;
}

bool could_be_fewer(const Model& model) {
  const auto& terms = model.terms();
  return terms.size() > 2 || std::any_of(terms.begin(), terms.end(),
                                         [](const Term& term) { return term.unknowns.size() > kFew; });
}

std::vector<Ranked> best_pairs(const SearchSetting& setting, const SearchRecords& records,
                               const std::vector<Ranked>& first) {
  const auto seconds = second_names(setting, records, firsts_among(first));
  if (seconds.empty() || setting.options.is_late()) return {};
  std::vector<Ranked> pairs;
  std::set<std::set<const Effect*>> names;
  for (auto& r : fit_chosen(setting, records, seconds)) {
    if (pairs.size() >= kFew) break;
    if (!std::isfinite(r.log_evidence) || r.outcome == CandidateOutcome::no_name) continue;
    const auto& terms = r.model.terms();
    if (names.insert({terms[terms.size() - 2].effect, r.effect}).second) pairs.push_back(std::move(r));
  }
  return pairs;
}

}  // namespace bodesmith::gap
