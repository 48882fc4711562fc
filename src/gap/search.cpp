#include "gap/search.hpp"

#include <utility>

#include "gap/runner.hpp"
#include "gap/search/base_fit.hpp"
#include "gap/search/grow.hpp"
#include "gap/search/no_names.hpp"
#include "gap/search/of_responses.hpp"
#include "gap/search/other_ways.hpp"
#include "gap/search/remaining.hpp"

namespace bodesmith::gap {
namespace {

/// Offsets that are free and given as 0, as a part of the output's range.
constexpr double kTypicalOffset = 0.05;
/// Progress before the base model's fit.
constexpr double kBegun = 0.02;

}  // namespace

SearchResult search(const chain::Chain& base, const Experiments& train, const SearchOptions& given) {
  const SearchOptions options = are_responses(train) ? for_responses(given, train) : given;
  SearchResult result;
  result.initial = Model(base);
  result.initial.set_signal_size(kTypicalOffset * largest_range(train));
  SearchSetting setting{options, result.initial};
  options.report(kBegun);
  auto [model, records] = fit_base(setting, make_records(train, options.stretches, result.initial));
  result.base = model;
  setting.first_gap = rms_of(model, records.train);
  const State begun{{std::move(model), {}, {}}, std::move(records), {}, {}};
  State state = begun;
  grow(setting, state);
  try_other_ways(setting, begun, state);
  try_other_partners(setting, state);
  take_out_no_names(setting, state);
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
