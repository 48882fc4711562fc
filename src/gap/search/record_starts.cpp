#include "gap/search/record_starts.hpp"

#include <utility>

#include "gap/evidence/noise_floor.hpp"
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
bool stands_out_at_start(const Model& model, const TimeExperiment& record) {
  const std::size_t start = record.start();
  TimeExperiment whole(record);
  whole.score_start();
  const auto all = residuals_of(model, {whole});
  const std::span residual = all;
  if (residual.size() <= start) return false;
  return rms(residual.first(start)) > kOverFloor * rms(residual.subspan(start));
}

}  // namespace

bool leave_out_wrong_starts(SearchRecords& records, const Model& model) {
  bool found = false;
  for_each_time_record(records, [&](TimeExperiment& e) {
    if (e.start_is_left_out() || e.start() == 0 || !stands_out_at_start(model, e)) return;
    e.leave_out_start();
    found = true;
  });
  return found;
}

void score_starts_again(const SearchSetting& setting, SearchRecords& records, Model& model) {
  const int before = starts_left_out(records);
  if (before == 0) return;
  SearchRecords all_scored = records;
  for_each_time_record(all_scored, [](TimeExperiment& e) { e.score_start(); });
  Model refitted = fit_in_turn(setting, all_scored, model).model;
  // Those that stand out even now stay left out.
  for_each_time_record(records, [&](TimeExperiment& e) {
    if (e.start_is_left_out() && !stands_out_at_start(refitted, e)) e.score_start();
  });
  if (starts_left_out(records) < before) model = fit_in_turn(setting, records, std::move(refitted)).model;
}

}  // namespace bodesmith::gap
