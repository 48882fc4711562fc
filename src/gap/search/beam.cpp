#include "gap/search/beam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "base/text.hpp"
#include "gap/evidence/names.hpp"
#include "gap/evidence/score.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search/between_samples.hpp"
#include "gap/search/moves.hpp"
#include "gap/search/record_starts.hpp"
#include "gap/search/remaining.hpp"
#include "gap/search/round.hpp"
#include "gap/search/stretches.hpp"

namespace bodesmith::gap {
namespace {

std::string names_in_words(const Model& model) {
  std::vector<std::string> names;
  for (const auto& term : model.terms()) names.emplace_back(term.effect->told());
  return join(names, " and ");
}

std::size_t count_of(const PlacedSet& set) {
  return set.model.terms().size();
}

void weigh(const SearchRecords& records, PlacedSet& set) {
  set.log_evidence = log_evidence(set.model, records.train);
  set.train_rms = rms_of(set.model, records.train);
}

/// The set without one of its terms, the others as they stand.
PlacedSet without(PlacedSet set, std::size_t term) {
  set.model.remove(term);
  set.rivals.erase(set.rivals.begin() + static_cast<std::ptrdiff_t>(term));
  return set;
}

/// The same, refitted.
PlacedSet without_term(const SearchSetting& setting, const SearchRecords& records, PlacedSet set,
                       std::size_t term) {
  set = without(std::move(set), term);
  set.model = fit_in_turn(setting, records, std::move(set.model)).model;
  weigh(records, set);
  return set;
}

/// A set with its starts looked at again and all of it settled; the beam's records follow, and its best set is weighed again by them.
PlacedSet settled(const SearchSetting& setting, Beam& beam, PlacedSet set) {
  set.model = fit_in_turn(setting, beam.records, std::move(set.model)).model;
  if (leave_out_wrong_starts(beam.records, set.model))
    set.model = fit_in_turn(setting, beam.records, std::move(set.model)).model;
  score_starts_again(setting, beam.records, set.model);
  beam.records.stretches = stretches_of(beam.records.train, set.model);
  set.model = fit_in_turn(setting, beam.records, std::move(set.model)).model;
  weigh(beam.records, beam.best);
  weigh(beam.records, set);
  return set;
}

/// A set with one of the candidates put in.
PlacedSet with_candidate(const PlacedSet& set, const Ranked& candidate, std::vector<Ranked> ranking) {
  PlacedSet more = set;
  more.model = candidate.model;
  more.rivals.push_back({std::move(ranking), set.log_evidence});
  return more;
}

/// One of a set's names as a candidate alongside the others.
Ranked as_it_stands(const PlacedSet& set, std::size_t term, double score) {
  Ranked r;
  r.effect = set.model.terms()[term].effect;
  r.placed = set.model.terms()[term].placed;
  r.model = set.model;
  r.model.move_term(term, count_of(set) - 1);
  r.score = score;
  r.train_rms = set.train_rms;
  r.log_evidence = set.log_evidence;
  return r;
}

/// Takes out every name without which the evidence is greater, or which takes too little: what has most unknowns first. One name
/// alone was weighed when it came in.
PlacedSet dropped(const SearchSetting& setting, const SearchRecords& records, PlacedSet set,
                  bool last_one_too = false) {
  for (bool again = true; again && count_of(set) > 0 && !setting.options.is_late();) {
    again = false;
    std::vector<std::size_t> order(count_of(set));
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return set.model.terms()[a].unknowns.size() > set.model.terms()[b].unknowns.size();
    });
    for (const std::size_t k : order) {
      const bool is_no_name = term_is_no_name(set.model, k, records.train);
      if (count_of(set) == 1 && !is_no_name && !last_one_too) break;
      auto less = without_term(setting, records, set, k);
      if (!is_no_name && matters(setting, records, less.model, set.train_rms) &&
          set.log_evidence > less.log_evidence)
        continue;
      less.notes.push_back(fmt::format("{} was taken out again: {}", set.model.terms()[k].effect->told(),
                                       is_no_name ? "with the others its values are another effect's form"
                                                  : "the others explain what it did"));
      set = std::move(less);
      again = true;
      break;
    }
  }
  return set;
}

/// What was tried in one name's place alongside the others, by how much was scored, the others' names and that one; and the set's evidence
/// with it. Many ways lead to the same sets.
struct Exchanged {
  PlacedSet::Rivals rivals;
  double log_evidence = 0.0;
};
using Exchanges = std::map<std::tuple<std::size_t, std::multiset<std::string>, std::string>, Exchanged>;

/// The set with another effect in the place of one, where that is of greater evidence; each place is tried against all effects,
/// alongside the others as they stand.
std::optional<PlacedSet> exchanged(const SearchSetting& setting, const SearchRecords& records, PlacedSet& set,
                                   bool last_is_fresh, Exchanges& exchanges) {
  for (std::size_t k = 0; k < count_of(set); ++k) {
    if (setting.options.is_late()) return std::nullopt;
    // The round that it was just chosen in looked at all there is.
    if (last_is_fresh && k + 1 == count_of(set)) continue;
    PlacedSet others = without(set, k);
    auto& before = exchanges[{scored_samples(records.train), names_of(others.model),
                              std::string(set.model.terms()[k].effect->name())}];
    // As long as the others' values are as good as they were: by less than what sets one name apart from another.
    if (!before.rivals.ranking.empty() && set.log_evidence < before.log_evidence - std::log(kTied)) {
      set.rivals[k] = before.rivals;
      continue;
    }
    weigh(records, others);
    auto ranking = fit_round(setting, records, others.model).ranking;
    // Of its own name what stands is known, too: the new fit alongside the others may have stopped short of it, or could not begin.
    auto own = std::find_if(ranking.begin(), ranking.end(),
                            [&](const Ranked& r) { return r.effect == set.model.terms()[k].effect; });
    if (own == ranking.end() || own->log_evidence < set.log_evidence) {
      if (own == ranking.end()) own = ranking.emplace(own);
      *own = as_it_stands(set, k, own->score);
      std::stable_sort(ranking.begin(), ranking.end(), more_evident);
    }
    const auto* best = best_of(setting, records, others.model, ranking);
    set.rivals[k] = {ranking, others.log_evidence};
    before = {set.rivals[k], set.log_evidence};
    if (best == nullptr || !(best->log_evidence > set.log_evidence)) continue;
    auto other = with_candidate(others, *best, ranking);
    // The same name again is what stands at better values, or at another place.
    if (best->effect == set.model.terms()[k].effect) {
      other.model.move_term(count_of(other) - 1, k);
      std::rotate(other.rivals.begin() + static_cast<std::ptrdiff_t>(k), other.rivals.end() - 1,
                  other.rivals.end());
    } else {
      other.notes.push_back(fmt::format("{} took the place of {} once the other terms were there",
                                        best->effect->told(), set.model.terms()[k].effect->told()));
    }
    other.model = fit_in_turn(setting, records, std::move(other.model)).model;
    weigh(records, other);
    if (best->effect == set.model.terms()[k].effect) before.log_evidence = other.log_evidence;
    return other;
  }
  return std::nullopt;
}

/// Names taken out and exchanged as long as that raises the evidence.
PlacedSet improved(const SearchSetting& setting, const SearchRecords& records, PlacedSet set,
                   Exchanges& exchanges) {
  const std::size_t count = count_of(set);
  set = dropped(setting, records, std::move(set));
  for (bool first = true; count_of(set) > 1; first = false) {
    const bool fresh = first && count_of(set) == count && set.rivals.back().ranking.size() > 1;
    auto other = exchanged(setting, records, set, fresh, exchanges);
    if (!other) break;
    set = dropped(setting, records, std::move(*other));
  }
  return set;
}

/// The round's best, settled, or where that is another effect's form once it is fitted to its end, the next best; whether that
/// raised the evidence.
bool one_more(const SearchSetting& setting, Beam& beam, Exchanges& exchanges) {
  auto [ranking, not_tried] = fit_round(setting, beam.records, beam.best.model);
  if (setting.options.stopped()) return false;
  beam.not_tried = std::move(not_tried);
  for (bool first = true;; first = false) {
    const auto* best = best_of(setting, beam.records, beam.best.model, ranking);
    if (first && count_of(beam.best) == 0) beam.first = ranking;
    if (best == nullptr || !(best->log_evidence > beam.best.log_evidence)) {
      if (first) beam.refused = std::move(ranking);
      return false;
    }
    const auto* effect = best->effect;
    auto next = settled(setting, beam, with_candidate(beam.best, *best, ranking));
    next = improved(setting, beam.records, std::move(next), exchanges);
    if (next.log_evidence > beam.best.log_evidence) {
      beam.best = std::move(next);
      return true;
    }
    beam.refused = ranking;
    if (count_of(next) > count_of(beam.best)) return false;
    std::erase_if(ranking, [&](const Ranked& r) { return r.effect == effect; });
  }
}

/// One name more after the other, as long as the evidence grows.
void grow(const SearchSetting& setting, Beam& beam, Exchanges& exchanges, bool report) {
  const auto& options = setting.options;
  while (static_cast<int>(count_of(beam.best)) < options.max_terms && !options.is_late()) {
    const auto terms = count_of(beam.best);
    // The base model's fit and what comes last are a round each.
    if (report) options.report((1.0 + static_cast<double>(terms)) / (2.0 + options.max_terms));
    if (terms > 0 && !beam.smooth_input) {
      if (auto smooth = with_smooth_input(setting, beam.records, beam.best.model)) {
        beam.best.model = std::move(*smooth);
        beam.smooth_input = true;
        weigh(beam.records, beam.best);
      }
    }
    if (!one_more(setting, beam, exchanges)) return;
  }
}

/// Where the engine's own error is a part of what is left, some names may stand for that: with more holds to a sample the set is
/// fitted anew, as is the base model's, and names go without which the evidence is greater. If that comes further, it was so.
void without_the_engines_own(const SearchSetting& setting, const PlacedSet& base_set, Beam& beam) {
  const std::size_t holds = enough_holds(beam.best.model, beam.records.train);
  if (holds == holds_of(beam.records.train)) return;
  Beam finer = beam;
  finer.records.set_holds(holds);
  const auto fitted = [&](PlacedSet set) {
    set.model = fit_in_turn(setting, finer.records, std::move(set.model)).model;
    weigh(finer.records, set);
    return set;
  };
  finer.best = dropped(setting, finer.records, fitted(std::move(finer.best)), true);
  if (PlacedSet base = fitted(base_set); base.log_evidence > finer.best.log_evidence)
    finer.best = std::move(base);
  if (finer.best.log_evidence > beam.best.log_evidence) beam = std::move(finer);
}

/// Two names at once, where one after the other came to no end, or one of many unknowns may stand for two others.
void try_pairs(const SearchSetting& setting, const Beam& base, Beam& beam, Exchanges& exchanges) {
  const auto& options = setting.options;
  std::set<std::multiset<std::string>> came_to = {names_of(beam.best.model)};
  for (auto& pair : best_pairs(setting, base.records, base.first)) {
    if (options.is_late()) return;
    // With one more name than the best set has it was looked at.
    const auto names = names_of(pair.model);
    const auto best = names_of(beam.best.model);
    if (!best.empty() && std::includes(names.begin(), names.end(), best.begin(), best.end())) continue;
    PlacedSet set = with_candidate(with_candidate(base.best, pair, base.first), pair, {pair});
    Beam other = base;
    set = settled(setting, other, std::move(set));
    // The best pair may hold one name too many or another's; of the others those that are better than what stands.
    const bool better = log_evidence(set.model, beam.records.train) > beam.best.log_evidence;
    if (!better && came_to.size() > 1) continue;
    set = improved(setting, other.records, std::move(set), exchanges);
    if (!came_to.insert(names_of(set.model)).second) continue;
    other.best = std::move(set);
    grow(setting, other, exchanges, false);
    // By the records of the one that stands.
    const double evidence = log_evidence(other.best.model, beam.records.train);
    if (!(evidence > beam.best.log_evidence)) continue;
    const bool left = is_something_left(other.best.model, other.records);
    other.best.notes.push_back(names_in_words(other.best.model) +
                               ", looked for together, came further than one name after the other");
    other.first = std::move(beam.first);
    beam = std::move(other);
    if (!left && !could_be_fewer(beam.best.model)) return;
  }
}

}  // namespace

std::multiset<std::string> names_of(const Model& model) {
  std::multiset<std::string> names;
  for (const auto& term : model.terms()) names.insert(std::string(term.effect->name()));
  return names;
}

void search_sets(const SearchSetting& setting, Beam& beam) {
  weigh(beam.records, beam.best);
  const auto& options = setting.options;
  const PlacedSet base_set = beam.best;
  SearchRecords base_records = beam.records;
  Exchanges exchanges;
  grow(setting, beam, exchanges, true);
  if (!options.is_late()) without_the_engines_own(setting, base_set, beam);
  if (options.max_terms < 2 || options.is_late()) return;
  if (is_something_left(beam.best.model, beam.records) || could_be_fewer(beam.best.model)) {
    Beam base;
    base.records = std::move(base_records);
    base.records.set_holds(holds_of(beam.records.train));
    base.best = base_set;
    base.first = beam.first;
    try_pairs(setting, base, beam, exchanges);
  }
}

}  // namespace bodesmith::gap
