#include "gap/records/response_weights.hpp"

#include <algorithm>
#include <cmath>

#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// A coherence of 0 does not say nothing of a point, and one that rounds to 1 not everything: instruments write four digits.
constexpr double kFromEnds = 1e-4;

/// Of each point's parts, relative to |H|^2; of one average where their number is not known.
std::vector<double> variances(const FrequencyRecord& record) {
  std::vector<double> out;
  for (std::size_t i = 0; i < record.coherence.size(); ++i) {
    const double g = std::clamp(record.coherence[i], kFromEnds, 1.0 - kFromEnds);
    const double n = record.averages.empty() ? 1.0 : record.averages[i];
    out.push_back((1.0 - g) / (2.0 * n * g));
  }
  return out;
}

}  // namespace

std::vector<double> response_weights(const FrequencyRecord& record) {
  if (record.coherence.empty()) return {};
  std::vector<double> weights;
  for (const double v : variances(record)) weights.push_back(1.0 / std::sqrt(v));
  const double size = rms(weights);
  for (double& w : weights) w /= size;
  return weights;
}

std::optional<double> noise_by_coherence(const FrequencyRecord& record) {
  if (record.coherence.empty() || record.averages.empty()) return std::nullopt;
  // Weighted, every point has the same variance.
  double inverse = 0.0;
  const auto all = variances(record);
  for (const double v : all) inverse += 1.0 / v;
  return std::sqrt(static_cast<double>(all.size()) / inverse);
}

}  // namespace bodesmith::gap
