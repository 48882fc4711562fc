#include "gap/search/moves.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search/round.hpp"

namespace bodesmith::gap {
namespace {

double explained(double before, double after) {
  return std::sqrt(std::max(0.0, before * before - after * after));
}

/// First names for pairs: the best of every effect, or of every effect at every place.
std::vector<Ranked> firsts_among(const SearchSetting& setting, std::vector<Ranked> ranking,
                                 bool at_every_place) {
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const Ranked& a, const Ranked& b) { return a.train_rms < b.train_rms; });
  std::set<std::pair<const Effect*, std::string>> seen;
  std::erase_if(ranking, [&](const Ranked& r) {
    return r.outcome == CandidateOutcome::no_name ||
           !seen.emplace(r.effect, at_every_place ? r.placed : std::string()).second;
  });
  if (ranking.size() > setting.options.pairs.firsts) ranking.resize(setting.options.pairs.firsts);
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
    for (auto& second : look_round(setting, records, first.model)) {
      if (effects.insert(second.proposal.term().effect).second)
        all.emplace_back(left * std::sqrt(std::max(0.0, 1.0 - second.score)), std::move(second));
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (all.size() > options.pairs.fits) all.resize(options.pairs.fits);
  std::vector<Promising> seconds;
  for (auto& each : all) seconds.push_back(std::move(each.second));
  return seconds;
}

}  // namespace

bool matters(const SearchSetting& setting, const SearchRecords& records, const Model& without,
             double rms_with) {
  const double before = rms_of(without, records.train);
  return explained(before, rms_with) >=
         setting.options.bounds.explained * std::sqrt(before * setting.first_gap);
}

bool all_matter(const SearchSetting& setting, const SearchRecords& records, const Model& model) {
  const double with = rms_of(model, records.train);
  for (std::size_t k = 0; k < model.terms().size(); ++k) {
    Model without = model;
    without.remove(k);
    without = fit_in_turn(setting, records, std::move(without)).model;
    if (!matters(setting, records, without, with)) return false;
  }
  return true;
}

bool term_is_no_name(const Model& model, std::size_t term, const Experiments& train) {
  if (are_responses(train)) return false;
  const auto& own = model.terms()[term];
  return own.effect->is_no_name(model, own, make_scene(model, train));
}

const Ranked* best_of(const SearchSetting& setting, const SearchRecords& records, const Model& without,
                      std::vector<Ranked>& ranking) {
  std::map<const Effect*, double> held;
  std::map<const Effect*, const Ranked*> best;
  for (auto& r : ranking) {
    if (!std::isfinite(r.log_evidence) || r.outcome == CandidateOutcome::no_name) continue;
    if (!matters(setting, records, without, r.train_rms)) {
      r.outcome = CandidateOutcome::takes_too_little;
    } else {
      // Greatest evidence first.
      if (best.emplace(r.effect, &r).second) {
        held[r.effect] = r.log_evidence;
      } else {
        held[r.effect] += std::log1p(std::exp(r.log_evidence - held[r.effect]));
      }
    }
  }
  const Ranked* winner = nullptr;
  for (const auto& r : ranking) {
    const auto found = best.find(r.effect);
    if (found == best.end() || found->second != &r) continue;
    if (winner == nullptr || held[r.effect] > held[winner->effect]) winner = &r;
  }
  return winner;
}

std::vector<Ranked> successors_of(const SearchSetting& setting, const SearchRecords& records,
                                  const Model& without) {
  SearchOptions few = setting.options;
  few.round.effects = few.round.successors;
  return fit_round({few, setting.initial, setting.first_gap}, records, without).ranking;
}

bool could_be_fewer(const SearchOptions& options, const Model& model) {
  const auto& terms = model.terms();
  return terms.size() > 2 || std::any_of(terms.begin(), terms.end(), [&](const Term& term) {
           return term.unknowns.size() >= options.round.many_unknowns;
         });
}

std::vector<std::pair<Ranked, Ranked>> best_pairs(const SearchSetting& setting, const SearchRecords& records,
                                                  const std::vector<Ranked>& first) {
  const auto firsts = firsts_among(setting, first, false);
  const auto seconds = second_names(setting, records, firsts);
  if (seconds.empty() || setting.options.is_late()) return {};
  std::vector<std::pair<Ranked, Ranked>> pairs;
  std::set<std::set<const Effect*>> names;
  for (const auto& r : fit_chosen(setting, records, seconds)) {
    if (pairs.size() >= setting.options.pairs.best) break;
    if (!std::isfinite(r.log_evidence) || r.outcome == CandidateOutcome::no_name) continue;
    const auto* own = r.model.terms()[r.model.terms().size() - 2].effect;
    const auto alone =
        std::find_if(firsts.begin(), firsts.end(), [&](const Ranked& f) { return f.effect == own; });
    if (names.insert({own, r.effect}).second) pairs.emplace_back(*alone, r);
  }
  return pairs;
}

std::vector<std::pair<Ranked, Ranked>> pairs_of_response(const SearchSetting& setting,
                                                         const SearchRecords& records,
                                                         const std::vector<Ranked>& first) {
  const auto& options = setting.options;
  std::vector<std::pair<Ranked, Ranked>> pairs;
  for (const auto& one : firsts_among(setting, first, true)) {
    if (options.is_late()) break;
    std::set<const Effect*> effects;
    for (auto& second : fit_round(setting, records, one.model).ranking) {
      if (effects.insert(second.effect).second) pairs.emplace_back(one, std::move(second));
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return more_evident(a.second, b.second); });
  if (pairs.size() > options.pairs.best) pairs.resize(options.pairs.best);
  return pairs;
}

}  // namespace bodesmith::gap
