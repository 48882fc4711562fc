#include "gap/search/other_ways.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "gap/search/grow.hpp"

namespace bodesmith::gap {
namespace {

/// Whether another way led further: to an end where this one did not, or with plainly less left; or as far with fewer
/// terms.
bool led_further(const SearchOptions& options, const State& other, const State& state) {
  const std::size_t terms = state.found.steps.size();
  const std::size_t others = other.found.steps.size();
  const auto& limits = options.other_ways;
  if (others == 0) return false;
  if (others < terms) return other.train_rms < limits.as_far * state.train_rms;
  if (is_settled(options, state)) return false;
  const bool settled = is_settled(options, other) && other.train_rms < limits.as_far * state.train_rms;
  return (settled && others <= terms + 1) || other.train_rms < limits.further * state.train_rms;
}

}  // namespace

void try_other_ways(const SearchSetting& setting, const State& base, State& state) {
  const auto& options = setting.options;
  std::set<const Effect*> tried;
  for (const auto& step : state.found.steps) tried.insert(step.effect);
  const auto first = state.first;
  std::size_t ways = 0;
  double best = setting.first_gap;
  for (const auto& r : first) best = std::min(best, r.train_rms);
  const double most =
      std::min(options.other_ways.max_left * setting.first_gap, options.other_ways.in_the_running * best);
  for (const auto& r : first) {
    const bool done = is_settled(options, state) && state.found.steps.size() <= options.other_ways.few_terms;
    if (state.found.steps.empty() || done || options.is_late() || ways >= options.other_ways.max_ways) return;
    if (r.condition_number > options.acceptance.max_condition || r.unknowns > options.acceptance.max_unknowns)
      continue;
    if (r.no_name || !(r.train_rms < most) || !tried.insert(r.effect).second) continue;
    ++ways;
    State other = base;
    other.other_way = true;
    Step step;
    step.effect = r.effect;
    step.placed = r.placed;
    step.before = base.found.model;
    step.after = r.model;
    step.ranking = first;
    for (auto& c : step.ranking) {
      const bool own = c.effect == r.effect && c.placed == r.placed && c.unknowns == r.unknowns;
      if (own)
        c.outcome = CandidateOutcome::named;
      else if (c.outcome == CandidateOutcome::named)
        c.outcome = CandidateOutcome::worse;
    }
    if (!take(setting, other, {std::move(step)})) continue;
    grow(setting, other);
    state.looked_at += other.looked_at;
    other.looked_at = state.looked_at;
    other.first = first;
    if (!led_further(options, other, state)) continue;
    state = std::move(other);
    state.found.notes.push_back(
        fmt::format("Begun with {}, the search came further than with the first name of the first round",
                    r.effect->name()));
  }
}

}  // namespace bodesmith::gap
