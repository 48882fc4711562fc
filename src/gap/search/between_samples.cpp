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

}  // namespace

std::optional<Model> with_smooth_input(const SearchSetting& setting, const SearchRecords& records,
                                       const Model& model) {
  const auto* first_record = std::get_if<TimeExperiment>(&records.train.front());
  if (first_record == nullptr) return std::nullopt;
  const double step_s = first_record->record().step_s;
  Model smooth = model;
  smooth.insert(0, chain::make_block("resonator")
                       .set("gain", 1.0)
                       .set("natural_frequency_hz", std::sqrt(12.0) / (2.0 * std::numbers::pi * step_s))
                       .set("damping_ratio", kDamping));
  auto fitted = fit_in_turn(setting, records, std::move(smooth));
  // It takes at least what a name must explain.
  const double most = (1.0 - kExplained) * rms_of(model, records.train);
  if (!fitted.usable() || !(rms_of(fitted.model, records.train) < most) ||
      !(log_evidence(fitted.model, records.train) > log_evidence(model, records.train) - log_share_of_name()))
    return std::nullopt;
  return std::move(fitted.model);
}

}  // namespace bodesmith::gap
