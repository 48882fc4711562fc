#include "gap/search/state.hpp"

#include <utility>

#include "gap/runner.hpp"
#include "gap/search/base_fit.hpp"
#include "gap/search/record_starts.hpp"
#include "gap/search/remaining.hpp"
#include "gap/search/stretches.hpp"

namespace bodesmith::gap {
namespace {

/// Iterations of the fit that follows a new term, and of the one that follows a change of what is scored.
constexpr int kJointIterations = 8;

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
  // A term that remembers, too.
  follow_what_is_left(tried.records.stretches, tried.records.train, tried.model, setting.options.stretches);
  found.model = settle(setting, tried.records, tried.model);
  return {std::move(found), std::move(tried.records)};
}

}  // namespace

bool is_settled(const SearchOptions& options, const State& state) {
  const auto floor = floor_under(state.found.model, state.records);
  const bool above =
      floor.source == NoiseFloor::Source::periods && state.train_rms > options.enough * floor.rms;
  return !above && state.structure.empty();
}

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

}  // namespace bodesmith::gap
