#include "gap/records/experiment.hpp"

#include <algorithm>
#include <utility>

#include "gap/records/response_weights.hpp"

namespace bodesmith::gap {

TimeExperiment::TimeExperiment(TimeRecord record, std::size_t start)
    : record_(std::make_shared<const TimeRecord>(std::move(record))),
      start_(start),
      left_out_(start),
      end_(record_->size()) {}

double TimeExperiment::range() const {
  if (record_->y.empty()) return 1.0;
  const auto [low, high] = std::minmax_element(record_->y.begin(), record_->y.end());
  return std::max(*high - *low, 1e-300);
}

std::span<const double> TimeExperiment::scored_part(std::span<const double> signal) const {
  return signal.subspan(first(), scored());
}

void TimeExperiment::use(std::size_t from, std::size_t end) {
  used_from_ = from;
  end_ = end;
  if (from > 0) start_ = left_out_ = 0;
}

FrequencyExperiment::FrequencyExperiment(FrequencyRecord record)
    : record_(std::make_shared<const FrequencyRecord>(std::move(record))),
      weights_(std::make_shared<const std::vector<double>>(response_weights(*record_))) {}

bool are_responses(const Experiments& experiments) {
  return !experiments.empty() && std::holds_alternative<FrequencyExperiment>(experiments.front());
}

void set_holds(Experiments& experiments, std::size_t holds) {
  for (Experiment& one : experiments) {
    if (auto* record = std::get_if<TimeExperiment>(&one)) record->set_holds(holds);
  }
}

std::size_t holds_of(const Experiments& experiments) {
  return are_responses(experiments) ? 1 : std::get<TimeExperiment>(experiments.front()).holds();
}

std::size_t scored_samples(const Experiments& experiments) {
  std::size_t total = 0;
  for (const auto& e : experiments)
    total += std::visit([](const auto& record) { return record.scored(); }, e);
  return total;
}

double largest_range(const Experiments& experiments) {
  double range = 0.0;
  for (const auto& e : experiments) {
    range = std::max(range, std::visit([](const auto& record) { return record.range(); }, e));
  }
  return range;
}

}  // namespace bodesmith::gap
