#include "gap/evidence/score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gap/effect.hpp"
#include "gap/runner.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// T. Twice as large: half the samples count, and a name's odds become their own square root. Chosen, not fitted (docs/gap.md).
constexpr double kTemperature = 6.0;
/// The least rms of a rest, in parts of the largest range: a term that leaves nothing at all leaves rounding.
constexpr double kLeastRest = 1e-9;

/// All but weights that rest at 0: what is at another end of its range was chosen as well.
double unknowns_in_use(const Model& model) {
  const auto unknowns = model.unknowns();
  return static_cast<double>(std::count_if(unknowns.begin(), unknowns.end(), [](const Unknown& u) {
    return !(u.low == 0.0 && !u.logarithmic && u.at_bound());
  }));
}

}  // namespace

std::vector<double> log_evidences(const std::vector<const Model*>& rivals, const Experiments& train) {
  std::vector<std::vector<double>> left(rivals.size());
  parallel_for(rivals.size(), allowed_threads(),
               [&](std::size_t i) { left[i] = residuals_of(*rivals[i], train); });
  const double least = kLeastRest * largest_range(train);
  std::vector<double> evidence(rivals.size(), -std::numeric_limits<double>::infinity());
  const std::vector<double>* nearest = nullptr;
  for (const auto& e : left) {
    if (!e.empty() && (nearest == nullptr || rms(e) < rms(*nearest))) nearest = &e;
  }
  if (nearest == nullptr) return evidence;
  const double tau = are_responses(train) ? 1.0 : correlation_time(*nearest);
  const double samples = std::max(1.0, static_cast<double>(nearest->size()) / (kTemperature * tau));
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    if (left[i].empty()) continue;
    evidence[i] = -samples * std::log(std::max(rms(left[i]), least)) -
                  0.5 * unknowns_in_use(*rivals[i]) * std::log(samples);
  }
  return evidence;
}

double log_share_of_name() {
  return -std::log(static_cast<double>(effect_registry().all().size()));
}

}  // namespace bodesmith::gap
