#include "gap/search/other_ways.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "gap/runner.hpp"
#include "gap/search/acceptance.hpp"
#include "gap/search/backward_elimination.hpp"
#include "gap/search/base_fit.hpp"
#include "gap/search/grow.hpp"
#include "gap/search/no_names.hpp"
#include "gap/search/pairs_at_once.hpp"
#include "gap/search/round.hpp"
#include "gap/search/step.hpp"

namespace bodesmith::gap {
namespace {

std::size_t unknowns_of(const State& state) {
  std::size_t count = 0;
  for (const auto& term : state.found.model.terms()) count += term.effective_unknowns();
  return count;
}

/// One or two names, of which one has many unknowns: it fits what it is not.
bool holds_a_family(const SearchOptions& options, const State& state) {
  const auto& terms = state.found.model.terms();
  return terms.size() <= options.other_ways.few_terms &&
         std::any_of(terms.begin(), terms.end(),
                     [&](const Term& t) { return t.unknowns.size() >= options.other_ways.family_unknowns; });
}

/// Whether another way led further: to an end where this one did not, or with plainly less left; or as far with fewer
/// terms.
bool led_further(const SearchOptions& options, const State& other, const State& state) {
  const std::size_t terms = state.found.steps.size();
  const std::size_t others = other.found.steps.size();
  const auto& limits = options.other_ways;
  if (others == 0) return false;
  if (others < terms) return other.train_rms < limits.as_far * state.train_rms;
  if (holds_a_family(options, state) && unknowns_of(other) + limits.family_spares <= unknowns_of(state))
    return other.train_rms <= state.train_rms;
  if (is_settled(options, state)) return false;
  // What leaves more comes to an end by fewer unknowns, or by chance.
  const double as_far = unknowns_of(other) < unknowns_of(state) ? limits.as_far : 1.0;
  const bool settled = is_settled(options, other) && other.train_rms < as_far * state.train_rms;
  return (settled && others <= std::max<std::size_t>(terms, 1) + 1) ||
         other.train_rms < limits.further * state.train_rms;
}

/// `other` in the place of `state`, which keeps what is told of the first round.
void go_the_other_way(State& state, State other, const std::string& note) {
  other.not_tried = std::move(state.not_tried);
  other.looked_at = state.looked_at;
  other.first = std::move(state.first);
  state = std::move(other);
  state.found.notes.push_back(note);
}

/// Each of a few names against every effect beside the others, as long as that leads to another one. Whether it did.
bool exchange_partners(const SearchSetting& setting, const SearchRecords& records, Found& found) {
  const auto& options = setting.options;
  bool any = false;
  for (std::size_t k = 0; k < options.other_ways.max_exchanges; ++k) {
    const std::size_t terms = found.steps.size();
    if (terms < 2 || terms > options.other_ways.max_partners || options.is_late()) break;
    auto exchanged = with_any_exchanged(setting, records, found);
    if (!exchanged) break;
    any = true;
    found = std::move(*exchanged);
    found.model = settle(setting, records, found.model);
  }
  return any;
}

bool all_earn_their_places(const SearchSetting& setting, const State& state) {
  const auto& model = state.found.model;
  if (term_without_name(model, state.records.train)) return false;
  for (std::size_t k = 0; k < model.terms().size(); ++k) {
    if (!without_term(setting, state.records, model, k).earns_its_place) return false;
  }
  return !model.terms().empty();
}

/// Names that two could do without: more of them than two, or one of many unknowns.
bool could_be_two(const SearchOptions& options, const State& state) {
  return state.found.steps.size() > options.other_ways.few_terms || holds_a_family(options, state);
}

std::set<const Effect*> effects_of(const std::vector<Step>& steps) {
  std::set<const Effect*> effects;
  for (const auto& step : steps) effects.insert(step.effect);
  return effects;
}

/// First names for pairs: besides those of the first round the effects that add one signal, whatever they promise alone (a
/// constant and a line may each leave as much as before without the other).
std::vector<Ranked> with_single_signals(const SearchSetting& setting, const State& base,
                                        std::vector<Ranked> first) {
  std::set<const Effect*> there;
  for (const auto& r : first) there.insert(r.effect);
  auto more = fit_whatever_is_promised(setting, base.records, base.found.model, [&](const Effect& effect) {
    return effect.adds_one_signal() && there.count(&effect) == 0;
  });
  std::move(more.begin(), more.end(), std::back_inserter(first));
  return first;
}

}  // namespace

void try_other_ways(const SearchSetting& setting, const State& base, State& state) {
  const auto& options = setting.options;
  const auto is_done = [&] { return is_settled(options, state) && !could_be_two(options, state); };
  if (are_responses(base.records.train) || is_done() || options.is_late()) return;
  // Less than a later term must explain is the form of the names that are there.
  if (!could_be_two(options, state) &&
      state.train_rms <
          options.acceptance.min_part_of_gap * gap_to_explain(setting, state.records, state.found.model))
    return;
  std::set<std::set<const Effect*>> came_to;
  const auto firsts = with_single_signals(setting, base, state.first);
  for (auto& [first, second] : pairs_at_once(setting, base.records, base.found.model, firsts)) {
    if (is_done() || options.is_late()) return;
    // Before anything is judged: one that takes a part of the other's share may be idle on the folds.
    Found together{second.after, {std::move(first), std::move(second)}, {}};
    exchange_partners(setting, base.records, together);
    const auto effects = effects_of(together.steps);
    if (!came_to.insert(effects).second) continue;
    if (effects == effects_of(state.found.steps) &&
        rms_of(together.model, base.records.train) > options.elimination.swap_gain * state.train_rms) {
      state.partners_tried = true;
      continue;
    }
    std::vector<std::string> names;
    for (const auto& step : together.steps) names.emplace_back(step.effect->name());
    together.steps.back().after = std::move(together.model);
    State other = base;
    other.other_way = true;
    if (!take(setting, other, std::move(together.steps))) continue;
    other.found.notes.insert(other.found.notes.end(), together.notes.begin(), together.notes.end());
    if (!all_earn_their_places(setting, other)) continue;
    grow(setting, other);
    if (led_further(options, other, state)) {
      go_the_other_way(state, std::move(other),
                       fmt::format("{}, put in together, came further than one name after the other",
                                   join(names, " and ")));
    }
  }
}

void try_other_partners(const SearchSetting& setting, State& state) {
  if (state.partners_tried || state.found.steps.size() < 2 || are_responses(state.records.train)) return;
  State other = state;
  if (!exchange_partners(setting, state.records, other.found)) {
    state = std::move(other);
    return;
  }
  if (!(rms_of(other.found.model, other.records.train) < setting.options.other_ways.as_far * state.train_rms))
    return;
  other.other_way = true;
  grow(setting, other);
  state = std::move(other);
}

}  // namespace bodesmith::gap
