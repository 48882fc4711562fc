#include "signal/periodogram.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "numeric/fourier.hpp"
#include "numeric/random.hpp"
#include "signal/statistics.hpp"

namespace bodesmith {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

Spectrum spectrum_of(std::span<const double> x, double start_s, double step_s, bool periodic) {
  const std::size_t n = x.size();
  if (n < 2) throw std::logic_error("a spectrum needs at least two samples");
  std::vector<double> weighted(x.begin(), x.end());
  double weight = static_cast<double>(n);
  if (!periodic) {
    weight = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double w = 0.5 - 0.5 * std::cos(kTurn * static_cast<double>(i) / static_cast<double>(n));
      weighted[i] *= w;
      weight += w;
    }
  }
  const std::vector<Complex> lines = half_spectrum(weighted);
  Spectrum out;
  double largest = 0.0;
  const double seconds = step_s * static_cast<double>(n);
  for (std::size_t k = 0; 2 * k <= n; ++k) {
    const bool once = k == 0 || 2 * k == n;  // the others stand for a pair of lines
    const double f = static_cast<double>(k) / seconds;
    const Complex line = lines[k] * std::polar((once ? 1.0 : 2.0) / weight, -kTurn * f * start_s);
    out.frequency.push_back(Hertz{f});
    out.amplitude.push_back(std::abs(line));
    out.phase_deg.push_back(to_degrees(std::arg(line)));
    largest = std::max(largest, out.amplitude.back());
  }
  out.phase_deg[0] = lines[0].real() < 0.0 ? 180.0 : 0.0;
  for (std::size_t k = 0; k < out.amplitude.size(); ++k) {
    if (out.amplitude[k] <= 1e-10 * largest) out.phase_deg[k] = 0.0;
  }
  return out;
}

std::optional<double> distortion_percent(const Spectrum& spectrum, std::size_t fundamental) {
  if (fundamental == 0 || fundamental >= spectrum.amplitude.size()) return std::nullopt;
  const double first = spectrum.amplitude[fundamental];
  if (!(first > 0.0)) return std::nullopt;
  double power = 0.0;
  for (std::size_t k = 2 * fundamental; k < spectrum.amplitude.size(); k += fundamental) {
    power += spectrum.amplitude[k] * spectrum.amplitude[k];
  }
  return 100.0 * std::sqrt(power) / first;
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

}  // namespace bodesmith
