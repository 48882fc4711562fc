#include "gap/search/between_samples.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "chain/registry.hpp"
#include "gap/evidence/score.hpp"
#include "gap/runner.hpp"

namespace bodesmith::gap {
namespace {

/// Damping is a delay (0.002 of a sample), too little of it rings for long behind every jump (100 samples).
constexpr double kDamping = 0.003;
/// Steps of records that differ by less than this part are the same.
constexpr double kSameStep = 1e-3;

/// The sample step of all records; nothing when they differ, or for frequency responses.
std::optional<double> common_step_s(const Experiments& records) {
  std::optional<double> step;
  for (const auto& e : records) {
    const auto* time = std::get_if<TimeExperiment>(&e);
    if (time == nullptr) return std::nullopt;
    const double own = time->record().step_s;
    if (step && std::abs(own / *step - 1.0) > kSameStep) return std::nullopt;
    step = own;
  }
  return step;
}

}  // namespace

std::optional<Model> with_smooth_input(const SearchSetting& setting, const SearchRecords& records,
                                       const Model& model) {
  const auto step_s = common_step_s(records.train);
  if (!step_s) return std::nullopt;
  Model smooth = model;
  smooth.insert(0, chain::make_block("resonator")
                       .set("gain", 1.0)
                       .set("natural_frequency_hz", std::sqrt(12.0) / (2.0 * std::numbers::pi * *step_s))
                       .set("damping_ratio", kDamping));
  // It takes at least what a name must explain.
  const double most = 1.0 - setting.options.bounds.explained;
  const auto first =
      fit(smooth, records.look(), fit_options(setting.options, setting.options.refit_iterations));
  if (!first.usable() || !(first.rms < most * rms_of(model, records.look()))) return std::nullopt;
  auto fitted = fit_in_turn(setting, records, first.model);
  if (!fitted.usable()) return std::nullopt;
  if (!(rms_of(fitted.model, records.train) < most * rms_of(model, records.train))) return std::nullopt;
  if (!(log_evidence(fitted.model, records.train) > log_evidence(model, records.train) - log_share_of_name()))
    return std::nullopt;
  return std::move(fitted.model);
}

}  // namespace bodesmith::gap
