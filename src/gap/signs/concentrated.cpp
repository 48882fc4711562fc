#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"
#include "numeric/fourier.hpp"

namespace bodesmith::gap {
namespace {

constexpr std::size_t kMinColumns = 7;

/// How unevenly the energy of each frequency is spread over time: sum over frequencies, weighted with their
/// energies, of the mean square of the power over the square of its mean, less 1. Gaussian noise of any colour: about
/// 1; a chirp: about the number of columns it shares its energy among.
double unevenness(const std::vector<double>& v, std::size_t window) {
  const std::size_t hop = window / 2;
  const std::size_t columns = (v.size() - window) / hop + 1;
  std::vector<double> sum(window / 2 + 1, 0.0);
  std::vector<double> squares(window / 2 + 1, 0.0);
  std::vector<double> part(window);
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t i = 0; i < window; ++i) {
      const double hann = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                               static_cast<double>(window));
      part[i] = hann * v[c * hop + i];
    }
    const auto bins = half_spectrum(part);
    for (std::size_t k = 0; k < bins.size(); ++k) {
      const double power = std::norm(bins[k]);
      sum[k] += power;
      squares[k] += power * power;
    }
  }
  double weighted = 0.0;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (sum[k] > 0.0) weighted += static_cast<double>(columns) * squares[k] / sum[k];
  }
  const double energy = std::accumulate(sum.begin(), sum.end(), 0.0);
  return energy > 0.0 ? weighted / energy - 1.0 : 0.0;
}

}  // namespace

Sign concentrated(const Leftover& record) {
  Sign sign{SignKind::concentrated, 0.0};
  const std::size_t n = record.residual.size();
  for (std::size_t window : {32U, 96U, 256U, 768U}) {
    if (n < window * (kMinColumns + 1) / 2) continue;
    const double got = unevenness(record.residual, window);
    const Chance chance = on_surrogates(record.residual, 5000,
                                        [&](const std::vector<double>& v) { return unevenness(v, window); });
    sign.strength = std::max(sign.strength, got / chance.limit());
  }
  return sign;
}

}  // namespace bodesmith::gap
