#include "gap/search/base_fit.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/record_starts.hpp"
#include "gap/search/stretches.hpp"

namespace bodesmith::gap {
namespace {

/// Rounds in which free responses and the model that makes them come to agree.
constexpr int kFreeResponseRounds = 3;

Model with_values(Model model, const std::vector<double>& values) {
  model.set_values(values);
  return model;
}

/// The best fit from every start; the model as given when none can be run.
Model refit_base(const SearchSetting& setting, const SearchRecords& records) {
  const auto& options = setting.options.base;
  std::optional<Model> best;
  double min_rms = 0.0;
  for (const auto& start : base_starts(setting, records.look())) {
    if (setting.options.is_late() && best) break;
    auto fitted =
        fit_in_turn(setting, records, with_values(setting.initial, start), setting.options.iterations);
    if (!fitted.usable()) continue;
    const double reached = rms_of(fitted.model, records.train);
    if (best && !(reached < options.other_hill * min_rms)) continue;
    min_rms = reached;
    best = std::move(fitted.model);
  }
  return best.value_or(setting.initial);
}

}  // namespace

BaseFit fit_base(const SearchSetting& setting, SearchRecords records) {
  Model model = refit_base(setting, records);
  auto wrong = leave_out_wrong_starts(setting, std::move(records), model);
  records = std::move(wrong.records);
  if (wrong.found) {
    // Free responses of a model that is off are of no use: first without the starts, then with them.
    model = refit_base(setting, leave_out_whole_starts(records));
    for (int round = 0; round < kFreeResponseRounds; ++round) {
      records = renew_free_responses(setting, std::move(records), model);
      model = fit_in_turn(setting, records, std::move(model)).model;
    }
  }
  follow_what_is_left(records.stretches, records.train, model, setting.options.stretches);
  return {std::move(model), std::move(records)};
}

}  // namespace bodesmith::gap
