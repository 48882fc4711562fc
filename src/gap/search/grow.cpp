#include "gap/search/grow.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search/acceptance.hpp"
#include "gap/search/between_samples.hpp"
#include "gap/search/group.hpp"
#include "gap/search/remaining.hpp"
#include "gap/search/round.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Progress behind the base model's fit; the rounds take the rest but a twentieth.
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

Round look_for_terms(const SearchSetting& setting, const State& state, bool pairs_allowed, bool little) {
  const auto& options = setting.options;
  const auto& records = state.records;
  const auto& model = state.found.model;
  // At the floor only what does not repeat with the input can be missing.
  const bool quiet = is_at_floor(options, model, records);
  const EffectFilter filter = [&](const Effect& effect) {
    return (!quiet || effect.independent_of_input()) && state.barred.count(&effect) == 0;
  };
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

/// The effects of a round's terms that are names only where they leave nothing.
std::set<const Effect*> all_or_nothing(const State& state, const std::vector<Step>& steps) {
  const auto scene = make_scene(state.found.model, state.records.train);
  std::set<const Effect*> found;
  for (const auto& step : steps) {
    if (step.effect->must_explain_all(scene)) found.insert(step.effect);
  }
  return found;
}

/// Whether all that is left is less than a later term must explain (AcceptanceOptions::min_part_of_gap): only one that
/// takes most of it is then a name.
bool is_little_left(const SearchSetting& setting, const SearchRecords& records, const Model& model) {
  const double enough = setting.options.acceptance.min_part_of_gap * gap_to_explain(setting, records, model);
  return rms_of(model, records.train) < enough && rms(round_residuals(model, records).folds) < enough;
}

/// What a candidate without a name still explains is no noise: of the rms, and in standard deviations.
constexpr double kMuchOfResidual = 0.2;
constexpr double kSurely = 8.0;

std::optional<Sign> sign_of_refused(const std::vector<Ranked>& refused, double train_rms) {
  double most = 0.0;
  for (const auto& r : refused) {
    if (r.least_z() > kSurely) most = std::max(most, 1.0 - std::max(r.train_rms, r.folds_rms) / train_rms);
  }
  if (!(most > kMuchOfResidual)) return std::nullopt;
  return Sign{SignKind::refused_candidate, most / kMuchOfResidual};
}

}  // namespace

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
    auto round = look_for_terms(setting, state, terms + 1 < options.max_terms, little);
    for (auto& note : round.notes) state.found.notes.push_back(std::move(note));
    state.not_tried = std::move(round.not_tried);
    state.looked_at += round.looked_at;
    if (terms == 0) state.first = round.ranking;
    if (round.steps.empty()) {
      state.refused = std::move(round.ranking);
      break;
    }
    terms += static_cast<int>(round.steps.size()) - 1;
    const auto doubtful = all_or_nothing(state, round.steps);
    std::optional<State> without;
    if (!doubtful.empty()) without = state;
    if (!take(setting, state, std::move(round.steps))) break;
    if (without && is_something_left(options, state.found.model, state.records)) {
      state = std::move(*without);
      state.barred.insert(doubtful.begin(), doubtful.end());
      terms = static_cast<int>(state.found.steps.size()) - 1;
    }
  }
  state.train_rms = rms_of(state.found.model, state.records.train);
  if (options.stopped()) return;
  state.structure = signs_left(state.found.model, state.records);
  // The ranking of a round that was taken back speaks of an earlier model.
  if (!state.taken_back) {
    if (auto sign = sign_of_refused(state.refused, state.train_rms)) state.structure.push_back(*sign);
  }
}

}  // namespace bodesmith::gap
