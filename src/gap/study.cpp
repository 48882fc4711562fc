#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "gap/diagnosis.hpp"
#include "gap/settle.hpp"
#include "signal/csv.hpp"

namespace bodesmith::gap {
namespace {

bool is_frequency_response(const std::filesystem::path& path) {
  Provenance aside;
  return Csv::read(path, aside).has("frequency_hz");
}

FrequencyRecord every_second(const FrequencyRecord& record, std::size_t first) {
  FrequencyRecord part;
  part.file = record.file;
  for (std::size_t i = first; i < record.frequency.size(); i += 2) {
    part.frequency.push_back(record.frequency[i]);
    part.response.push_back(record.response[i]);
  }
  return part;
}

std::unique_ptr<TimeExperiment> prepared(TimeRecord record, const chain::Chain& base) {
  const auto skip = unscored_samples(base, record);
  auto e = std::make_unique<TimeExperiment>(std::move(record));
  e->set_skip(skip);
  return e;
}

void check(const TimeRecord& record) {
  if (record.size() < 64) {
    throw InputError(record.file, 0, fmt::format("has {} samples, expected at least 64", record.size()));
  }
}

}  // namespace

void Study::add(std::unique_ptr<Experiment> experiment, bool held_out) {
  (held_out ? holdout_ : train_).push_back(experiment.get());
  owned_.push_back(std::move(experiment));
}

Study Study::of(std::vector<TimeRecord> data, std::vector<TimeRecord> holdout, const chain::Chain& base) {
  Study study;
  study.split_ = holdout.empty();
  for (auto& record : data) {
    check(record);
    const auto cut = record.size() * 7 / 10;
    if (study.split_) {
      auto later = std::make_unique<TimeExperiment>(record);
      later->set_skip(cut);
      later->never_score_start();
      study.add(std::move(later), true);
    }
    auto e = prepared(std::move(record), base);
    if (study.split_) e->set_to(cut);
    study.add(std::move(e), false);
  }
  for (auto& record : holdout) {
    check(record);
    study.add(prepared(std::move(record), base), true);
  }
  return study;
}

Study Study::read(const std::vector<std::filesystem::path>& data,
                  const std::vector<std::filesystem::path>& holdout, const chain::Chain& base,
                  Provenance& from) {
  if (data.empty()) throw InputError("no record to fit, expected at least one CSV file");
  const bool frequency = is_frequency_response(data.front());
  for (const auto* files : {&data, &holdout}) {
    for (const auto& path : *files) {
      if (is_frequency_response(path) == frequency) continue;
      throw InputError(
          path.string(), 0,
          fmt::format("is a {}, expected a {} like {}", frequency ? "time record" : "frequency response",
                      frequency ? "frequency response" : "time record", data.front().string()));
    }
  }
  if (!frequency) {
    std::vector<TimeRecord> train;
    std::vector<TimeRecord> held_out;
    for (const auto& path : data) train.push_back(TimeRecord::read_csv(path, from, true));
    for (const auto& path : holdout) held_out.push_back(TimeRecord::read_csv(path, from, true));
    return of(std::move(train), std::move(held_out), base);
  }
  Study study;
  study.frequency_ = true;
  study.split_ = holdout.empty();
  for (const auto& path : data) {
    const auto record = FrequencyRecord::read_csv(path, from);
    if (record.frequency.size() < 8) {
      throw InputError(record.file, 0,
                       fmt::format("has {} frequencies, expected at least 8", record.frequency.size()));
    }
    if (!chain::Chain(base).response(record.frequency.front().rad_s())) {
      throw InputError(
          record.file, 0,
          "is a frequency response, but the model has a nonlinear block, expected time records for it");
    }
    if (study.split_) study.add(std::make_unique<FrequencyExperiment>(every_second(record, 1)), true);
    study.add(std::make_unique<FrequencyExperiment>(study.split_ ? every_second(record, 0) : record), false);
  }
  for (const auto& path : holdout)
    study.add(std::make_unique<FrequencyExperiment>(FrequencyRecord::read_csv(path, from)), true);
  return study;
}

}  // namespace bodesmith::gap
