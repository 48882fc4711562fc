#include "gap/evidence/noise_floor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/whole_number.hpp"
#include "gap/signs/chance.hpp"
#include "numeric/fourier.hpp"
#include "signal/period.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// The input's band ends where only this part of its power lies above.
constexpr double kPowerAboveBand = 1e-6;

}  // namespace

std::string to_string(NoiseFloor::Source source) {
  constexpr std::array kNames = {"periods", "high_frequency", "unknown"};
  return kNames.at(static_cast<std::size_t>(source));
}

NoiseFloor floor_from_periods(const std::vector<double>& residual, std::size_t period) {
  NoiseFloor floor;
  if (period == 0 || residual.size() < 2 * period) return floor;
  const std::size_t periods = residual.size() / period;
  // Whole periods at the end of the record: farthest from any start transient.
  const std::size_t first = residual.size() - periods * period;
  std::vector<double> average(period, 0.0);
  for (std::size_t p = 0; p < periods; ++p) {
    for (std::size_t i = 0; i < period; ++i) average[i] += residual[first + p * period + i];
  }
  for (double& a : average) a /= static_cast<double>(periods);
  double spread = 0.0;
  for (std::size_t p = 0; p < periods; ++p) {
    for (std::size_t i = 0; i < period; ++i) {
      const double d = residual[first + p * period + i] - average[i];
      spread += d * d;
    }
  }
  const double variance = spread / static_cast<double>(period * (periods - 1));
  floor.source = NoiseFloor::Source::periods;
  floor.rms = std::sqrt(variance);
  floor.most_noise = kOverFloor * floor.rms;
  floor.period = period;
  floor.periods = static_cast<int>(periods);
  const auto bins = half_spectrum(average);
  const double n = static_cast<double>(period);
  double odd = 0.0;
  double even = 0.0;
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const double power = std::norm(bins[k]) / (n * n) * (k == 0 || 2 * k == period ? 1.0 : 2.0);
    (k % 2 == 1 ? odd : even) += power;
  }
  const double noise_each = 0.5 * variance / static_cast<double>(periods);
  floor.odd_rms = std::sqrt(std::max(0.0, odd - noise_each));
  floor.even_rms = std::sqrt(std::max(0.0, even - noise_each));
  return floor;
}

NoiseFloor floor_from_high_frequencies(const std::vector<double>& residual, const std::vector<double>& input,
                                       double step_s) {
  NoiseFloor floor;
  const auto u = periodogram(input, step_s);
  double total = 0.0;
  for (double p : u.power) total += p;
  if (!(total > 0.0)) return floor;
  double above = 0.0;
  std::size_t top = u.power.size();
  while (top > 1 && above + u.power[top - 1] < kPowerAboveBand * total) above += u.power[--top];
  const auto e = periodogram(residual, step_s);
  const auto from = whole_number<std::size_t>(static_cast<double>(top) * u.bin_hz / e.bin_hz) + 1;
  // Half way between the input's top and Nyquist and beyond: harmonics have died down there.
  const std::size_t begin = from + (std::max(from, e.power.size()) - from) / 2;
  if (begin + kNeighbours > e.power.size()) return floor;
  const double density =
      median({e.power.begin() + static_cast<std::ptrdiff_t>(begin), e.power.end()}) / std::log(2.0);
  floor.source = NoiseFloor::Source::high_frequency;
  floor.rms = std::sqrt(density * static_cast<double>(e.power.size()));
  // Noise x(t) = rho x(t-1) + w stands by root of (1 + rho)/(1 - rho) over its own level there.
  floor.most_noise =
      kOverFloor * floor.rms * std::sqrt(2.0 * kLongestNoise * static_cast<double>(residual.size()));
  return floor;
}

NoiseFloor noise_floor(const std::vector<double>& residual, const std::vector<double>& input, double step_s) {
  const auto floor = floor_from_periods(residual, find_period(input));
  return floor.source == NoiseFloor::Source::periods ? floor
                                                     : floor_from_high_frequencies(residual, input, step_s);
}

}  // namespace bodesmith::gap
