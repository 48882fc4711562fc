#include "signal/periodogram.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <unsupported/Eigen/FFT>

#include "numeric/random.hpp"
#include "signal/statistics.hpp"

namespace bodesmith {

std::size_t smooth_length(std::size_t n) {
  for (std::size_t m = n; m > 1; --m) {
    std::size_t rest = m;
    for (std::size_t p : {2U, 3U, 5U}) {
      while (rest % p == 0) rest /= p;
    }
    if (rest == 1 && m % 2 == 0) return m;
  }
  return n;
}

std::vector<std::complex<double>> half_spectrum(const std::vector<double>& v) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> bins;
  fft.fwd(bins, v);
  return bins;
}

std::vector<double> from_half_spectrum(const std::vector<std::complex<double>>& bins, std::size_t n) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> v;
  fft.inv(v, bins, static_cast<Eigen::Index>(n));
  return v;
}

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

std::size_t find_period(const std::vector<double>& v, double tolerance) {
  const std::size_t n = v.size();
  if (n < 16) return 0;
  const double middle = mean(v);
  double energy = 0.0;
  for (double x : v) energy += (x - middle) * (x - middle);
  if (!(energy > 0.0)) return 0;
  // Mean squared difference at lag p, from the autocorrelation of the zero-padded signal.
  std::size_t padded = 1;
  while (padded < 2 * n) padded *= 2;
  std::vector<double> x(padded, 0.0);
  std::vector<double> cumulated(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = v[i] - middle;
    cumulated[i + 1] = cumulated[i] + x[i] * x[i];
  }
  auto bins = half_spectrum(x);
  for (auto& b : bins) b = std::norm(b);
  const auto correlation = from_half_spectrum(bins, padded);
  const double mean_square = energy / static_cast<double>(n);
  for (std::size_t p = 8; p <= n / 2; ++p) {
    const double pairs = static_cast<double>(n - p);
    const double distance = (cumulated[n - p] + (cumulated[n] - cumulated[p]) - 2.0 * correlation[p]) / pairs;
    if (distance > tolerance * tolerance * mean_square) continue;
    // A slow signal is like itself at every small lag: only a minimum beyond the first decorrelation counts.
    std::size_t leave = 1;
    while (leave < p && correlation[leave] > 0.5 * correlation[0]) ++leave;
    if (p <= 2 * leave) continue;
    // Neighbouring lags may be better still.
    std::size_t best = p;
    double least = distance;
    for (std::size_t q = p + 1; q <= std::min(n / 2, p + leave); ++q) {
      const double d = (cumulated[n - q] + (cumulated[n] - cumulated[q]) - 2.0 * correlation[q]) /
                       static_cast<double>(n - q);
      if (d < least) {
        least = d;
        best = q;
      }
    }
    return best;
  }
  return 0;
}

}  // namespace bodesmith
