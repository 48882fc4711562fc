#include "gap/search/base_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "gap/runner.hpp"
#include "gap/search/record_starts.hpp"
#include "gap/search/stretches.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Rounds in which free responses and the model that makes them come to agree.
constexpr int kFreeResponseRounds = 3;

Model with_values(Model model, const std::vector<double>& values) {
  model.set_values(values);
  return model;
}

/// Where the base model's fits begin: at the given values, and where a comb over its frequencies, all together and each alone, leaves least
/// (near its peak a resonance's sum of squares is hilly).
std::vector<Model> base_starts(const SearchSetting& setting, const Experiments& look) {
  const auto& options = setting.options.base;
  const auto unknowns = setting.initial.unknowns();
  const auto given = current_values(setting.initial);
  auto best = given;
  double least = std::numeric_limits<double>::infinity();
  Runner runner(setting.initial, look);
  const auto look_at = [&](const std::vector<double>& values) {
    std::vector<double> residual;
    if (!runner(values, residual) || !(rms(residual) < least)) return;
    least = rms(residual);
    best = values;
  };
  // Fits of responses find their hill alone.
  for (double f = -options.comb_reach; !are_responses(look) && f < options.comb_reach;
       f += options.comb_step) {
    auto all = given;
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
      if (!unknowns[k].is_frequency()) continue;
      auto one = given;
      one[k] = all[k] = std::clamp(given[k] * std::exp(f), unknowns[k].low, unknowns[k].high);
      look_at(one);
    }
    look_at(all);
  }
  if (best == given) return {setting.initial};
  return {setting.initial, with_values(setting.initial, best)};
}

/// The best fit from every start; the model as given when none can be run.
Model refit_base(const SearchSetting& setting, const SearchRecords& records) {
  std::optional<Model> best;
  double min_rms = 0.0;
  for (auto& start : base_starts(setting, records.look())) {
    if (setting.options.is_late() && best) break;
    auto fitted = fit_in_turn(setting, records, std::move(start), setting.options.iterations);
    if (!fitted.usable()) continue;
    const double reached = rms_of(fitted.model, records.train);
    if (best && !(reached < setting.options.base.other_hill * min_rms)) continue;
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
