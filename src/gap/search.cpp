#include "gap/search.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/acceptance.hpp"
#include "gap/search/backward_elimination.hpp"
#include "gap/search/base_fit.hpp"
#include "gap/search/between_samples.hpp"
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
  if (options.stopped() || round.ranking.empty()) return round;
  auto judged = judge(setting, records, model, std::move(round.ranking));
  round.ranking = std::move(judged.ranking);
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

}  // namespace

SearchResult search(const chain::Chain& base, const Experiments& train, const SearchOptions& options) {
  SearchResult result;
  result.initial = Model(base);
  result.initial.set_signal_size(kTypicalOffset * largest_range(train));
  SearchSetting setting{options, result.initial};
  options.report(kBegun);
  auto [model, records] = fit_base(setting, make_records(train, options.stretches));
  result.base = model;
  setting.first_gap = rms_of(model, records.train);
  Found found{std::move(model), {}, {}};
  bool smooth_input = false;
  bool taken_back = false;
  for (int terms = 0; terms < options.max_terms && !options.is_late(); ++terms) {
    options.report(kBaseFitted + kRounds * terms / options.max_terms);
    if (terms > 0 && !smooth_input) {
      if (auto smooth = with_smooth_input(setting, records, found.model)) {
        found.model = std::move(*smooth);
        smooth_input = true;
      }
    }
    const bool little = terms > 0 && is_little_left(setting, records, found.model);
    auto round = look_for_terms(setting, records, found.model, terms + 1 < options.max_terms, little);
    for (auto& note : round.notes) found.notes.push_back(std::move(note));
    result.not_tried = std::move(round.not_tried);
    result.looked_at += round.looked_at;
    if (round.steps.empty()) {
      result.refused = std::move(round.ranking);
      break;
    }
    if (round.steps.size() > 1) ++terms;
    const auto ranking = round.steps.back().ranking;
    auto extended = extend(setting, records, found, std::move(round.steps));
    records = std::move(extended.records);
    // Whatever was taken out or put in another's place: a round must leave the error smaller.
    const double enough = (1.0 - options.acceptance.min_gain) * rms_of(found.model, records.train);
    if (!(rms_of(extended.found.model, records.train) <= enough)) {
      found.notes = std::move(extended.found.notes);
      taken_back = true;
      result.refused = ranking;
      break;
    }
    found = std::move(extended.found);
  }
  result.stopped = options.stopped();
  result.late = options.is_late();
  result.floor = floor_under(found.model, records);
  result.train_rms = rms_of(found.model, records.train);
  if (!result.stopped) {
    result.structure = signs_left(found.model, records);
    // The ranking of a round that was taken back speaks of an earlier model.
    if (!taken_back) {
      if (auto sign = sign_of_refused(result.refused, result.train_rms)) result.structure.push_back(*sign);
    }
  }
  result.final = std::move(found.model);
  result.steps = std::move(found.steps);
  result.notes = std::move(found.notes);
  if (smooth_input)
    result.notes.emplace_back(
        "The input goes in a curve between the samples, where a model takes it as straight: the first resonator of "
        "model.toml, at 0.55 of the sampling rate, stands for that and is no effect");
  options.report(1.0);
  return result;
}

}  // namespace bodesmith::gap
