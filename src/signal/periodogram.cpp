#include "signal/periodogram.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "numeric/fourier.hpp"
#include "numeric/random.hpp"
#include "signal/statistics.hpp"

namespace bodesmith {

Periodogram periodogram(const std::vector<double>& v, double step_s) {
  const std::size_t n = smooth_length(v.size());
  std::vector<double> windowed(n);
  double window_power = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double w = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                          static_cast<double>(n));
    windowed[i] = w * v[i];
    window_power += w * w;
  }
  const auto bins = half_spectrum(windowed);
  Periodogram p;
  p.bin_hz = 1.0 / (step_s * static_cast<double>(n));
  p.power.resize(bins.size());
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const double both_sides = k == 0 || 2 * k == n ? 1.0 : 2.0;
    p.power[k] = both_sides * std::norm(bins[k]) / (window_power * static_cast<double>(n));
  }
  return p;
}

std::vector<double> phase_surrogate(const std::vector<double>& v, std::uint64_t seed) {
  const std::size_t n = smooth_length(v.size());
  const double middle = mean(v);
  std::vector<double> centred(n);
  for (std::size_t i = 0; i < n; ++i) centred[i] = v[i] - middle;
  auto bins = half_spectrum(centred);
  std::mt19937_64 random(seed);
  for (std::size_t k = 1; k < bins.size(); ++k) {
    const double phase = 2.0 * std::numbers::pi * unit_interval(random());
    bins[k] = 2 * k == n ? bins[k] : std::polar(std::abs(bins[k]), phase);
  }
  auto turned = from_half_spectrum(bins, n);
  std::vector<double> out(v.size());
  // The surrogate is periodic by construction, so its beginning continues its end.
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = turned[i % n];
  return out;
}

}  // namespace bodesmith
