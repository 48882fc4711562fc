#include "gap/search/record_starts.hpp"

#include <utility>

#include "gap/runner.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

template <class Function>
void for_each_time_record(SearchRecords& records, Function function) {
  for (auto& e : records.train) {
    if (auto* time = std::get_if<TimeExperiment>(&e)) function(*time);
  }
}

int starts_left_out(SearchRecords& records) {
  int count = 0;
  for_each_time_record(records, [&](const TimeExperiment& e) { count += e.start_is_left_out() ? 1 : 0; });
  return count;
}

/// Whether the residual of a whole record is plainly larger at its start than in the rest.
bool stands_out_at_start(const SearchOptions& options, const Model& model, const TimeExperiment& record) {
  const std::size_t start = record.start();
  TimeExperiment whole(record);
  whole.score_start();
  const auto all = residuals_of(model, {whole});
  const std::span residual = all;
  if (residual.size() <= start) return false;
  return rms(residual.first(start)) > options.start_stands_out * rms(residual.subspan(start));
}

}  // namespace

WrongStarts leave_out_wrong_starts(const SearchSetting& setting, SearchRecords records, const Model& model) {
  const auto& options = setting.options;
  bool found = false;
  for_each_time_record(records, [&](TimeExperiment& e) {
    if (e.start_is_left_out() || e.start() == 0 || !stands_out_at_start(options, model, e)) return;
    e.leave_out_start();
    found = true;
  });
  return {std::move(records), found};
}

StartsTried score_starts_again(const SearchSetting& setting, SearchRecords records, Model model) {
  const auto& options = setting.options;
  const int before = starts_left_out(records);
  if (before == 0) return {std::move(records), std::move(model)};
  SearchRecords all_scored = records;
  for_each_time_record(all_scored, [](TimeExperiment& e) { e.score_start(); });
  Model refitted = fit_in_turn(setting, all_scored, model).model;
  // Those that stand out even now stay left out.
  SearchRecords tried = records;
  for_each_time_record(tried, [&](TimeExperiment& e) {
    if (e.start_is_left_out() && !stands_out_at_start(options, refitted, e)) e.score_start();
  });
  if (starts_left_out(tried) == before) return {std::move(records), std::move(model)};
  model = fit_in_turn(setting, tried, std::move(refitted)).model;
  return {std::move(tried), std::move(model)};
}

}  // namespace bodesmith::gap
