#include "gap/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/acceptance.hpp"
#include "gap/search/backward_elimination.hpp"
#include "gap/search/base_fit.hpp"
#include "gap/search/between_samples.hpp"
#include "gap/search/group.hpp"
#include "gap/search/record_starts.hpp"
#include "gap/search/records.hpp"
#include "gap/search/remaining.hpp"
#include "gap/search/round.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Iterations of the fit that follows a new term, and of the one that follows a change of what is scored.
constexpr int kJointIterations = 8;
/// Offsets that are free and given as 0, as a part of the output's range.
constexpr double kTypicalOffset = 0.05;
/// Progress before the base model's fit and after it; the rounds take the rest but a twentieth.
constexpr double kBegun = 0.02;
constexpr double kBaseFitted = 0.05;
constexpr double kRounds = 0.9;

/// The terms that a round finds: one, or two that hide each other; none, and the ranking that shows why.
struct Round {
  std::vector<Step> steps;
  std::vector<Ranked> ranking;
  std::vector<std::string> not_tried;
  std::size_t looked_at = 0;
  std::vector<std::string> notes;
};

bool are_responses(const Experiments& experiments) {
  return !experiments.empty() && std::holds_alternative<FrequencyExperiment>(experiments.front());
}

Round look_for_terms(const SearchSetting& setting, const SearchRecords& records, const Model& model,
                     bool pairs_allowed, bool little) {
  const auto& options = setting.options;
  // At the floor only what does not repeat with the input can be missing.
  const bool quiet = is_at_floor(options, model, records);
  EffectFilter filter;
  if (quiet) filter = [](const Effect& effect) { return effect.independent_of_input(); };
  Round round;
  auto fitted = fit_round(setting, records, model, filter,
                          little ? options.round.min_score_of_little : options.round.min_score);
  round.ranking = std::move(fitted.ranking);
  round.not_tried = std::move(fitted.not_tried);
  round.looked_at = fitted.looked_at;
  if (options.stopped() || (round.ranking.empty() && !are_responses(records.train))) return round;
  auto judged = judge(setting, records, model, std::move(round.ranking));
  round.ranking = std::move(judged.ranking);
  if (are_responses(records.train) && !options.is_late() && !quiet && !little && pairs_allowed) {
    auto group = choose_group(setting, records, model, round.ranking, judged.step ? &*judged.step : nullptr);
    if (group) {
      round.steps = std::move(group->steps);
      round.notes = {std::move(group->note)};
      return round;
    }
  }
  if (judged.step) {
    round.steps.push_back(std::move(*judged.step));
  } else if (!options.is_late() && !quiet && !little && pairs_allowed &&
             is_something_left(options, model, records)) {
    if (auto pair = choose_pair(setting, records, model, round.ranking)) {
      round.steps = {std::move(pair->first), std::move(pair->second)};
      round.notes = {std::move(pair->note)};
    }
  }
  return round;
}

/// A step's model refitted as a whole.
Model refit_jointly(const SearchSetting& setting, const SearchRecords& records, const Model& model) {
  return fit_in_turn(setting, records, model, kJointIterations).model;
}

/// What is found with a round's terms put in, earlier ones tested again, starts looked at again, and all of
/// it settled.
struct Extended {
  Found found;
  SearchRecords records;
};
Extended extend(const SearchSetting& setting, SearchRecords records, Found found, std::vector<Step> steps) {
  steps.back().after = refit_jointly(setting, records, steps.back().after);
  found.model = steps.back().after;
  for (auto& step : steps) found.steps.push_back(std::move(step));
  found = test_earlier_terms(setting, records, std::move(found));
  auto wrong = leave_out_wrong_starts(setting, std::move(records), found.model);
  if (wrong.found)
    found.model = fit_in_turn(setting, wrong.records, std::move(found.model), kJointIterations).model;
  auto tried = score_starts_again(setting, std::move(wrong.records), std::move(found.model));
  found.model = settle(setting, tried.records, tried.model);
  return {std::move(found), std::move(tried.records)};
}

/// Whether all that is left is less than a later term must explain (AcceptanceOptions::min_part_of_gap): only one that
/// takes most of it is then a name.
bool is_little_left(const SearchSetting& setting, const SearchRecords& records, const Model& model) {
  const double enough = setting.options.acceptance.min_part_of_gap * setting.first_gap;
  return rms_of(model, records.train) < enough && rms(round_residuals(model, records).folds) < enough;
}

/// What a candidate without a name still explains is no noise: of the rms, and in standard deviations.
constexpr double kMuchOfResidual = 0.2;
constexpr double kSurely = 8.0;

std::optional<Sign> sign_of_refused(const std::vector<Ranked>& refused, double train_rms) {
  double most = 0.0;
  for (const auto& r : refused) {
    const bool sure =
        std::min(r.z, r.train_z) > kSurely && r.outcome != CandidateOutcome::no_more_than_control;
    if (sure) most = std::max(most, 1.0 - std::max(r.train_rms, r.folds_rms) / train_rms);
  }
  if (!(most > kMuchOfResidual)) return std::nullopt;
  return Sign{SignKind::refused_candidate, most / kMuchOfResidual};
}

/// Where a search has come to.
struct State {
  Found found;
  SearchRecords records;
  std::vector<Ranked> first;    ///< ranking of the first round
  std::vector<Ranked> refused;  ///< of the round in which nothing earned its place
  std::vector<std::string> not_tried = {};
  std::size_t looked_at = 0;
  bool smooth_input = false;
  /// The last round left no less and does not count: its ranking is of another model.
  bool taken_back = false;
  bool other_way = false;            ///< begun again with another first name
  std::vector<Sign> structure = {};  ///< what is left
  double train_rms = 0.0;
};

/// A round's terms put in; false when what comes of it leaves no less.
bool take(const SearchSetting& setting, State& state, std::vector<Step> steps) {
  const auto ranking = steps.back().ranking;
  auto extended = extend(setting, state.records, state.found, std::move(steps));
  // Whatever was taken out or put in another's place: a round must leave the error smaller.
  const double enough =
      (1.0 - setting.options.acceptance.min_gain) * rms_of(state.found.model, extended.records.train);
  state.records = std::move(extended.records);
  if (!(rms_of(extended.found.model, state.records.train) <= enough)) {
    state.found.notes = std::move(extended.found.notes);
    state.taken_back = true;
    state.refused = ranking;
    return false;
  }
  state.found = std::move(extended.found);
  return true;
}

/// Round after round until nothing more earns its place.
void grow(const SearchSetting& setting, State& state) {
  const auto& options = setting.options;
  for (int terms = static_cast<int>(state.found.steps.size());
       terms < options.max_terms && !options.is_late(); ++terms) {
    if (!state.other_way) options.report(kBaseFitted + kRounds * terms / options.max_terms);
    if (terms > 0 && !state.smooth_input) {
      if (auto smooth = with_smooth_input(setting, state.records, state.found.model)) {
        state.found.model = std::move(*smooth);
        state.smooth_input = true;
      }
    }
    const bool little = terms > 0 && is_little_left(setting, state.records, state.found.model);
    auto round =
        look_for_terms(setting, state.records, state.found.model, terms + 1 < options.max_terms, little);
    for (auto& note : round.notes) state.found.notes.push_back(std::move(note));
    state.not_tried = std::move(round.not_tried);
    state.looked_at += round.looked_at;
    if (terms == 0) state.first = round.ranking;
    if (round.steps.empty()) {
      state.refused = std::move(round.ranking);
      break;
    }
    terms += static_cast<int>(round.steps.size()) - 1;
    if (!take(setting, state, std::move(round.steps))) break;
  }
  state.train_rms = rms_of(state.found.model, state.records.train);
  if (options.stopped()) return;
  state.structure = signs_left(state.found.model, state.records);
  // The ranking of a round that was taken back speaks of an earlier model.
  if (!state.taken_back) {
    if (auto sign = sign_of_refused(state.refused, state.train_rms)) state.structure.push_back(*sign);
  }
}

bool is_settled(const SearchOptions& options, const State& state) {
  const auto floor = floor_under(state.found.model, state.records);
  const bool above =
      floor.source == NoiseFloor::Source::periods && state.train_rms > options.enough * floor.rms;
  return !above && state.structure.empty();
}

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

/// The first name decides what the later ones can be. When the search came to no end, or only with many terms, it is
/// begun again with the next effects of the first round.
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

/// Fits of responses are quick, so that none is given up behind the leader; and curves that differ by less than this are
/// one, whatever they are called (a logarithmic creep, a fractional lag).
constexpr double kNeverBehind = 1e12;
constexpr double kSameCurve = 0.006;
/// Standard deviations where coherence makes the noise of all points alike; otherwise the points that carry a term may be
/// noisier than the others, which makes it look surer than it is.
constexpr double kSureOfWeighted = 3.5;

SearchOptions for_responses(SearchOptions options, const Experiments& train) {
  const bool weighted = std::all_of(train.begin(), train.end(), [](const Experiment& e) {
    return !std::get<FrequencyExperiment>(e).weights().empty();
  });
  if (weighted)
    options.acceptance.min_significance = std::min(options.acceptance.min_significance, kSureOfWeighted);
  options.round.far_behind = options.round.behind = kNeverBehind;
  options.acceptance.tie_surely_within = std::max(options.acceptance.tie_surely_within, kSameCurve);
  return options;
}

}  // namespace

SearchResult search(const chain::Chain& base, const Experiments& train, const SearchOptions& given) {
  const SearchOptions options = are_responses(train) ? for_responses(given, train) : given;
  SearchResult result;
  result.initial = Model(base);
  result.initial.set_signal_size(kTypicalOffset * largest_range(train));
  SearchSetting setting{options, result.initial};
  options.report(kBegun);
  auto [model, records] = fit_base(setting, make_records(train, options.stretches));
  result.base = model;
  setting.first_gap = rms_of(model, records.train);
  const State begun{{std::move(model), {}, {}}, std::move(records), {}, {}};
  State state = begun;
  grow(setting, state);
  try_other_ways(setting, begun, state);
  result.stopped = options.stopped();
  result.late = options.is_late();
  result.refused = std::move(state.refused);
  result.not_tried = std::move(state.not_tried);
  result.looked_at = state.looked_at;
  result.floor = floor_under(state.found.model, state.records);
  result.train_rms = state.train_rms;
  result.structure = std::move(state.structure);
  Found& found = state.found;
  result.final = std::move(found.model);
  result.steps = std::move(found.steps);
  result.notes = std::move(found.notes);
  if (state.smooth_input)
    result.notes.emplace_back(
        "The input goes in a curve between the samples, where a model takes it as straight: the first resonator of "
        "model.toml, at 0.55 of the sampling rate, stands for that and is no effect");
  options.report(1.0);
  return result;
}

}  // namespace bodesmith::gap
