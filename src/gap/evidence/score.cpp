#include "gap/evidence/score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <variant>
#include <vector>

#include "gap/effect.hpp"
#include "gap/runner.hpp"
#include "signal/red_noise.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// T. Twice as large: a name's odds become their own square root. Chosen, not fitted (docs/gap.md).
constexpr double kTemperature = 6.0;
/// The least rms of a rest, in parts of the largest range: a term that leaves nothing at all leaves rounding.
constexpr double kLeastRest = 1e-9;

double log_likelihood(const std::vector<double>& residual, const Experiments& train, double size) {
  const double left = std::max(rms(residual), kLeastRest * size);
  const auto n = static_cast<double>(residual.size());
  if (are_responses(train) || left <= kLeastRest * size) return -n * std::log(left);
  std::vector<std::span<const double>> records;
  std::size_t from = 0;
  for (const auto& e : train) {
    const std::size_t count = std::get<TimeExperiment>(e).scored();
    records.push_back(std::span(residual).subspan(from, count));
    from += count;
  }
  return most_likely_red_noise(records).log_likelihood;
}

}  // namespace

double log_evidence(const Model& model, const Experiments& train) {
  const auto residual = residuals_of(model, train);
  if (residual.empty()) return -std::numeric_limits<double>::infinity();
  const auto unknowns = model.unknowns();
  const auto in_use = static_cast<double>(
      std::count_if(unknowns.begin(), unknowns.end(), [](const Unknown& u) { return !u.at_bound(); }));
  const double likelihood = log_likelihood(residual, train, largest_range(train));
  return (likelihood - 0.5 * in_use * std::log(static_cast<double>(residual.size()))) / kTemperature;
}

double log_share_of_name() {
  return -std::log(static_cast<double>(effect_registry().all().size()));
}

}  // namespace bodesmith::gap
