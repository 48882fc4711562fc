#include "gap/search/base_fit.hpp"

#include <utility>

#include "gap/search/record_starts.hpp"
#include "gap/search/stretches.hpp"

namespace bodesmith::gap {
namespace {

/// The model as given when it cannot be run.
Model refit_base(const SearchSetting& setting, const SearchRecords& records) {
  auto fitted = fit_in_turn(setting, records, setting.initial, setting.options.iterations);
  return fitted.usable() ? std::move(fitted.model) : setting.initial;
}

}  // namespace

BaseFit fit_base(const SearchSetting& setting, SearchRecords records) {
  Model model = refit_base(setting, records);
  auto wrong = leave_out_wrong_starts(setting, std::move(records), model);
  records = std::move(wrong.records);
  if (wrong.found) model = refit_base(setting, records);
  follow_what_is_left(records.stretches, records.train, model, setting.options.stretches);
  return {std::move(model), std::move(records)};
}

}  // namespace bodesmith::gap
