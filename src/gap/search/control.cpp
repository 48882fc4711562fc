#include <algorithm>
#include <optional>

#include "gap/runner.hpp"
#include "gap/search/acceptance.hpp"
#include "signal/periodogram.hpp"

namespace bodesmith::gap {
namespace {

/// Fits on surrogate records: the model before is their truth, so few steps will do.
constexpr int kIterationsBefore = 4;
constexpr int kIterationsAfter = 6;

/// The record as it would be if `before` were the truth: its output, and noise with the spectrum of what
/// `after` leaves (so that what the term took away, a line of the mains, does not stand in the noise) and
/// random phases.
std::optional<TimeExperiment> surrogate_of(const TimeExperiment& experiment, const Model& before,
                                           const Model& after, std::uint64_t seed) {
  auto y = output_of(before, experiment);
  if (y.empty()) return std::nullopt;
  const auto explained = output_of(after, experiment);
  if (explained.empty()) return std::nullopt;
  std::vector<double> residual;
  for (std::size_t i = experiment.first(); i < experiment.end(); ++i)
    residual.push_back(experiment.record().y[i] - explained[i]);
  experiment.take_out_free_responses(residual);
  const auto noise = phase_surrogate(residual, seed);
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] += noise[(i + noise.size() - experiment.first() % noise.size()) % noise.size()];
  return experiment.with_output(std::move(y));
}

/// Surrogates of all records; nothing when there are frequency responses among them, or the models cannot be
/// run.
std::optional<SearchRecords> surrogates_of(const SearchRecords& records, const Model& before,
                                           const Model& after, std::uint64_t seed) {
  SearchRecords surrogates;
  const auto add = [&](const Experiments& from, Experiments& to) {
    for (const auto& e : from) {
      const auto* time = std::get_if<TimeExperiment>(&e);
      if (time == nullptr) return false;
      auto surrogate = surrogate_of(*time, before, after, seed++);
      if (!surrogate) return false;
      to.emplace_back(std::move(*surrogate));
    }
    return true;
  };
  if (!add(records.train, surrogates.train)) return std::nullopt;
  return surrogates;
}

}  // namespace

double control_gain(const SearchSetting& setting, const SearchRecords& records, const Model& before,
                    const Ranked& candidate) {
  const auto& options = setting.options;
  double max_gain = 0.0;
  for (std::uint64_t k = 0; k < options.acceptance.controls; ++k) {
    const auto surrogates = surrogates_of(records, before, candidate.model, options.seed * 77 + 13 * k);
    if (!surrogates) return 0.0;
    const auto plain = fit(before, surrogates->train, fit_options(options, kIterationsBefore)).model;
    const auto with_term = fit(candidate.model, surrogates->train, fit_options(options, kIterationsAfter));
    if (!with_term.result.usable()) continue;
    // `before` is the truth of these records: a refit of it that got worse is no gain of the term's.
    const double without = std::min(rms_of(plain, surrogates->train), rms_of(before, surrogates->train));
    max_gain = std::max(max_gain, 1.0 - rms_of(with_term.model, surrogates->train) / without);
  }
  return max_gain;
}

}  // namespace bodesmith::gap
