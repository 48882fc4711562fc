#include "gap/search/remaining.hpp"

#include <algorithm>
#include <optional>

#include "base/whole_number.hpp"
#include "gap/records/response_weights.hpp"
#include "gap/runner.hpp"

namespace bodesmith::gap {
namespace {

/// What the model leaves of a record from a sample on; nothing where it cannot be run.
std::optional<Leftover> leftover_from(std::size_t first, const Model& model,
                                      const TimeExperiment& experiment) {
  const auto output = output_of(model, experiment);
  if (output.empty()) return std::nullopt;
  const auto& record = experiment.record();
  Leftover l;
  l.step_s = record.step_s;
  for (std::size_t i = first; i < experiment.end(); ++i) {
    l.residual.push_back(record.y[i] - output[i]);
    l.input.push_back(record.u[i]);
    l.output.push_back(output[i]);
  }
  return l;
}

NoiseFloor floor_of(const Model& model, const TimeExperiment& experiment) {
  const auto left = leftover_from(experiment.start(), model, experiment);
  return left ? noise_floor(left->residual, left->input, left->step_s) : NoiseFloor();
}

/// What coherence says, whatever the model leaves.
NoiseFloor floor_of(const Model&, const FrequencyExperiment& experiment) {
  NoiseFloor floor;
  const auto noise = noise_by_coherence(experiment.record());
  if (!noise) return floor;
  floor.rms = *noise;
  floor.most_noise = kOverFloor * floor.rms;
  floor.source = NoiseFloor::Source::periods;
  const auto& averages = experiment.record().averages;
  floor.periods = whole_number<int>(*std::min_element(averages.begin(), averages.end()));
  return floor;
}

std::optional<Leftover> leftover_of(const Model& model, const TimeExperiment& experiment) {
  auto l = leftover_from(experiment.first(), model, experiment);
  if (l) l->dynamics = model.linear_part(0);
  return l;
}

std::optional<Leftover> leftover_of(const Model& model, const FrequencyExperiment& experiment) {
  Leftover l;
  l.response = residuals_of(model, {experiment});
  return l;
}

std::vector<Leftover> leftovers_of(const Model& model, const Experiments& records) {
  std::vector<Leftover> all;
  for (const auto& e : records) {
    if (auto l = std::visit([&](const auto& record) { return leftover_of(model, record); }, e))
      all.push_back(std::move(*l));
  }
  return all;
}

}  // namespace

NoiseFloor floor_under(const Model& model, const SearchRecords& records) {
  for (const auto& e : records.train) {
    const auto floor = std::visit([&](const auto& record) { return floor_of(model, record); }, e);
    if (floor.source != NoiseFloor::Source::unknown) return floor;
  }
  return {};
}

std::vector<Sign> signs_left(const Model& model, const SearchRecords& records) {
  return signs_of_structure(leftovers_of(model, records.train));
}

bool is_something_left(const Model& model, const SearchRecords& records) {
  return rms_of(model, records.train) > floor_under(model, records).most_noise ||
         !signs_left(model, records).empty();
}

}  // namespace bodesmith::gap
