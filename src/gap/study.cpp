#include "gap/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "base/error.hpp"
#include "gap/records/settling.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::gap {
namespace {

constexpr std::size_t kMinFrequencies = 8;

bool is_frequency_response(const std::filesystem::path& path) {
  Provenance aside;
  return Csv::read(path, aside).has(column::frequency_hz);
}

/// Throws InputError unless all files are of one kind.
void validate_kinds(const std::vector<std::filesystem::path>& files, const std::filesystem::path& like,
                    bool frequency) {
  for (const auto& path : files) {
    if (is_frequency_response(path) == frequency) continue;
    throw InputError(
        path.string(), 0,
        fmt::format("is a {}, expected a {} like {}", frequency ? "time record" : "frequency response",
                    frequency ? "frequency response" : "time record", like.string()));
  }
}

void validate_size(const std::string& file, std::size_t size, std::size_t min_size, const char* what) {
  if (size < min_size) {
    throw InputError(file, 0, fmt::format("has {} {}, expected at least {}", size, what, min_size));
  }
}

void validate(const TimeRecord& record) {
  validate_size(record.file, record.size(), kLeastSamples, "samples");
  record.require_measured_sizes();
}

TimeExperiment experiment_with_start(TimeRecord record, const chain::Chain& base) {
  const auto start = start_samples(base, record);
  return TimeExperiment(std::move(record), start);
}

auto content_of(const TimeRecord& record) {
  return std::tie(record.u, record.y);
}

std::vector<std::array<double, 3>> content_of(const FrequencyRecord& record) {
  std::vector<std::array<double, 3>> all;
  for (std::size_t i = 0; i < record.frequency.size(); ++i)
    all.push_back({record.frequency[i].value, record.response[i].real(), record.response[i].imag()});
  return all;
}

/// In the order of what they hold: which of them was named first tells nothing.
void sort_by_content(auto& records) {
  std::ranges::stable_sort(records, {}, [](const auto& record) { return content_of(record); });
}

template <class Read>
auto all_of(const std::vector<std::filesystem::path>& files, Read read) {
  std::vector<std::invoke_result_t<Read, std::filesystem::path>> records;
  for (const auto& path : files) records.push_back(read(path));
  return records;
}

}  // namespace

void Study::set_holds(std::size_t holds) {
  gap::set_holds(train_, holds);
  gap::set_holds(holdout_, holds);
}

bool Study::frequency_responses() const {
  return are_responses(train_);
}

bool Study::weighted() const {
  const auto is_weighted = [](const Experiment& e) {
    const auto* response = std::get_if<FrequencyExperiment>(&e);
    return response != nullptr && !response->weights().empty();
  };
  return std::ranges::any_of(train_, is_weighted) || std::ranges::any_of(holdout_, is_weighted);
}

Study Study::of(std::vector<TimeRecord> data, std::vector<TimeRecord> holdout, const chain::Chain& base) {
  Study study;
  study.split_ = holdout.empty();
  for (const auto& record : data) validate(record);
  sort_by_content(data);
  for (auto& record : data) {
    const std::size_t size = record.size();
    const std::size_t cut = size * 7 / 10;
    auto experiment = experiment_with_start(std::move(record), base);
    if (study.split_) {
      TimeExperiment later(experiment);
      later.use(cut, size);
      study.holdout_.emplace_back(std::move(later));
      experiment.use(0, cut);
    }
    study.train_.emplace_back(std::move(experiment));
  }
  for (auto& record : holdout) {
    validate(record);
    study.holdout_.emplace_back(experiment_with_start(std::move(record), base));
  }
  return study;
}

Study Study::of(std::vector<FrequencyRecord> data, std::vector<FrequencyRecord> holdout,
                const chain::Chain& base) {
  Study study;
  study.split_ = holdout.empty();
  for (const auto& record : data) {
    validate_size(record.file, record.frequency.size(), kMinFrequencies, "frequencies");
    if (!base.response(record.frequency.front().rad_s())) {
      throw InputError(
          record.file, 0,
          "is a frequency response, but the model has a nonlinear block, expected time records for it");
    }
  }
  sort_by_content(data);
  for (auto& record : data) {
    if (study.split_) study.holdout_.emplace_back(FrequencyExperiment(record.thinned(1, 2)));
    study.train_.emplace_back(FrequencyExperiment(study.split_ ? record.thinned(0, 2) : std::move(record)));
  }
  for (auto& record : holdout) study.holdout_.emplace_back(FrequencyExperiment(std::move(record)));
  return study;
}

Study Study::read(const std::vector<std::filesystem::path>& data,
                  const std::vector<std::filesystem::path>& holdout, const chain::Chain& base,
                  Provenance& from) {
  if (data.empty()) throw InputError("no record to fit, expected at least one CSV file");
  const bool frequency = is_frequency_response(data.front());
  validate_kinds(data, data.front(), frequency);
  validate_kinds(holdout, data.front(), frequency);
  const auto study_by = [&](auto read) {
    auto train = all_of(data, read);
    return of(std::move(train), all_of(holdout, read), base);
  };
  if (frequency) return study_by([&](const auto& path) { return FrequencyRecord::read_csv(path, from); });
  return study_by([&](const auto& path) { return TimeRecord::read_csv(path, from, true); });
}

}  // namespace bodesmith::gap
