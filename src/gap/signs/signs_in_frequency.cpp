#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "gap/search_options.hpp"
#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Neighbours begin beyond the width of the periodogram's window.
constexpr std::size_t kWindowBins = 4;

/// What the energy of one point of noise over the mean of so many reaches as seldom as the other signs: (1 + x/n)^-n of them is greater
/// than x.
const double kStandsApart =
    static_cast<double>(kNeighbours) * std::expm1(kLogDeviations / static_cast<double>(kNeighbours));

/// Level around bin k: the larger of the means to both sides, so that a slope does not count. Nothing near the ends.
std::optional<double> level_around(const std::vector<double>& power, std::size_t k) {
  double below = 0.0;
  double above = 0.0;
  std::size_t counted_below = 0;
  std::size_t counted_above = 0;
  for (std::size_t d = kWindowBins; d < kWindowBins + kNeighbours; ++d) {
    if (k >= d + 1) {
      below += power[k - d];
      ++counted_below;
    }
    if (k + d < power.size()) {
      above += power[k + d];
      ++counted_above;
    }
  }
  if (std::min(counted_below, counted_above) < kWindowBins) return std::nullopt;
  return std::max(below / static_cast<double>(counted_below), above / static_cast<double>(counted_above));
}

}  // namespace

Sign spectral_line(const Leftover& record) {
  Sign sign{SignKind::spectral_line, 0.0};
  const auto power = periodogram(less_straight_line(record.residual), record.step_s).power;
  const double total = std::accumulate(power.begin(), power.end(), 0.0);
  // The largest of n bins of noise lies about ln n above their mean.
  const double limit = std::log(static_cast<double>(power.size())) + kLogDeviations;
  for (std::size_t k = kWindowBins; k + kWindowBins < power.size(); ++k) {
    if (power[k] < power[k - 1] || power[k] < power[k + 1]) continue;
    const auto level = level_around(power, k);
    if (!level || power[k - 1] + power[k] + power[k + 1] < kLeastShare * total) continue;
    sign.strength = std::max(sign.strength, power[k] / std::max(*level, 1e-300) / limit);
  }
  return sign;
}

Sign stands_apart(const Leftover& record) {
  Sign sign{SignKind::stands_apart, 0.0};
  const std::size_t n = record.response.size() / 2;
  std::vector<double> energy(n);
  for (std::size_t i = 0; i < n; ++i)
    energy[i] = std::pow(record.response[2 * i], 2) + std::pow(record.response[2 * i + 1], 2);
  for (std::size_t i = 0; i < n; ++i) {
    if (const auto level = level_around(energy, i))
      sign.strength = std::max(sign.strength, energy[i] / std::max(*level, 1e-300) / kStandsApart);
  }
  return sign;
}

Sign smooth_over_frequency(const Leftover& record) {
  const std::size_t n = record.response.size() / 2;
  double together = 0.0;
  double energy = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t part = 0; part < 2; ++part) {
      const double e = record.response[2 * i + part];
      energy += e * e;
      if (i > 0) together += e * record.response[2 * (i - 1) + part];
    }
  }
  // Independent errors: the correlation of neighbours has the deviation 1/sqrt(2n).
  const double z = energy > 0.0 ? together / energy * std::sqrt(2.0 * static_cast<double>(n)) : 0.0;
  return {SignKind::smooth_over_frequency, z / kDeviations};
}

}  // namespace bodesmith::gap
