#include "gap/search/record_starts.hpp"

#include <algorithm>
#include <cmath>
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
bool stands_out_at_start(const StartOptions& options, const Model& model, const TimeExperiment& record) {
  const std::size_t start = record.start();
  TimeExperiment whole(record);
  whole.score_start();
  const auto all = residuals_of(model, {whole});
  const std::span residual = all;
  if (residual.size() <= start) return false;
  return rms(residual.first(start)) > options.stands_out * rms(residual.subspan(start));
}

void leave_out(const StartOptions& options, const Model& model, TimeExperiment& record) {
  const auto size = static_cast<double>(record.end());
  if (static_cast<double>(record.start()) < options.max_part * size) {
    record.leave_out_start(record.start());
    return;
  }
  const std::size_t first = record.end() * options.percent_with_free_start / 100;
  record.leave_out_start(first, free_responses(model, record, first));
}

}  // namespace

WrongStarts leave_out_wrong_starts(const SearchSetting& setting, SearchRecords records, const Model& model) {
  const auto& options = setting.options.starts;
  bool found = false;
  for_each_time_record(records, [&](TimeExperiment& e) {
    if (e.start_is_left_out() || e.start() == 0 || !stands_out_at_start(options, model, e)) return;
    e.leave_out_start(e.start());
    found = true;
  });
  if (found) records = renew_free_responses(setting, std::move(records), model);
  return {std::move(records), found};
}

SearchRecords renew_free_responses(const SearchSetting& setting, SearchRecords records, const Model& model) {
  for_each_time_record(records, [&](TimeExperiment& e) {
    if (e.start_is_left_out()) leave_out(setting.options.starts, model, e);
  });
  return records;
}

SearchRecords leave_out_whole_starts(SearchRecords records) {
  for_each_time_record(records, [](TimeExperiment& e) {
    if (e.start_is_left_out()) e.leave_out_start(e.start());
  });
  return records;
}

StartsTried score_starts_again(const SearchSetting& setting, SearchRecords records, Model model) {
  const auto& options = setting.options.starts;
  const int before = starts_left_out(records);
  if (before == 0) return {std::move(records), std::move(model)};
  SearchRecords all_scored = records;
  for_each_time_record(all_scored, [](TimeExperiment& e) { e.score_start(); });
  Model refitted = fit_in_turn(setting, all_scored, model).model;
  // Those that stand out even now stay left out.
  SearchRecords tried = records;
  for_each_time_record(tried, [&](TimeExperiment& e) {
    if (!e.start_is_left_out()) return;
    if (stands_out_at_start(options, refitted, e)) {
      leave_out(options, refitted, e);
    } else {
      e.score_start();
    }
  });
  if (starts_left_out(tried) < before) {
    model = fit_in_turn(setting, tried, std::move(refitted)).model;
    records = std::move(tried);
  }
  return {renew_free_responses(setting, std::move(records), model), std::move(model)};
}

}  // namespace bodesmith::gap
