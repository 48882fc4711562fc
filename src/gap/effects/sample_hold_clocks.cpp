#include "gap/effects/sample_hold_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "base/whole_number.hpp"
#include "numeric/fourier.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith::gap {
namespace {

/// Clocks of the first look in one cycle over its length, and new ones on either side of each in the next.
constexpr int kFinerClocks = 2;
/// Samples of the first look.
constexpr std::size_t kFirstLook = 1200;
/// The fastest clock that is looked for, in samplings: a hold faster than the record leaves images that sampling
/// folds down.
constexpr double kFastestClock = 1.6;
/// Clocks per sampling from which on one transform tells which of them are worth a look: four in five of those of the first one. Within
/// four samples a signal that can be followed goes straight.
constexpr double kFastClock = 0.25;

/// A figure of merit and the clock it belongs to, Hz.
using ScoredClock = std::pair<double, double>;

Starts starts_of(const std::vector<ScoredClock>& scored) {
  Starts starts;
  for (const auto& [size, f] : scored) {
    if (size > 0.0) starts.push_back({f});
  }
  return starts;
}

/// The best, best first, that lie further apart than `apart_hz`: neighbours are one peak.
void keep_best(std::vector<ScoredClock>& clocks, double apart_hz, std::size_t count = kMostFound) {
  std::sort(clocks.rbegin(), clocks.rend());
  clocks = best_apart(
      clocks, [&](const auto& a, const auto& b) { return std::abs(a.second - b.second) < apart_hz; }, count);
}

/// Share of the residual along a feature, in energy; 0 when they point apart.
struct Likeness {
  double along = 0.0;
  double size = 0.0;
  void add(double residual, double feature) {
    along += residual * feature;
    size += feature * feature;
  }
  double value() const { return along > 0.0 && size > 0.0 ? along * along / size : 0.0; }
};

/// Likeness of samples `from` … n - 1 of a residual to stairs of a signal less the signal, or less their own mean lag. The signal is a
/// sample longer; every edge is worked out anew, since a branch that tells where one is costs more.
double likeness_to_stairs(const std::vector<double>& signal, const std::vector<double>& residual, bool half,
                          bool with_lag, double clock, std::size_t from, std::size_t n) {
  const double cycle = 1.0 / clock;
  const double late = half ? 0.5 * cycle : 0.0;
  const double lag = 0.5 * cycle + late;
  const auto first = whole_number<std::size_t>(std::ceil(lag));
  const std::size_t shift = with_lag ? 0 : first;
  const double share = with_lag ? 0.0 : static_cast<double>(first) - lag;
  const auto between = [&](std::size_t k, double part) {
    return signal[k] + part * (signal[k + 1] - signal[k]);
  };
  const auto below = [](double s) { return static_cast<std::int64_t>(s); };  // by one instruction
  Likeness likeness;
  for (std::size_t i = std::max(from, first); i < n; ++i) {
    const double edge = cycle * static_cast<double>(below((static_cast<double>(i) - late) * clock));
    const std::int64_t k = below(edge);
    const double held = between(static_cast<std::size_t>(k), edge - static_cast<double>(k));
    likeness.add(residual[i], held - between(i - shift, share));
  }
  return likeness.value();
}

/// Fast clocks by what one transform tells of them all, in cycles per sample, the best first. Where the signal goes straight its stairs
/// less their mean lag are its slope times ½ - frac(f t) = Σ sin(2π m f t)/(π m) over f, of which three terms will do; t runs half a
/// cycle late with the hold. Spaced as the first comb; the slope is that of the mean lag of each octave's middle.
std::vector<ScoredClock> likely_fast_clocks(const std::vector<double>& signal,
                                            const std::vector<double>& residual, bool half, double low,
                                            std::size_t n) {
  const std::size_t length = kFinerClocks * n;
  std::vector<ScoredClock> found;
  for (double octave = kFastClock; octave < kFastestClock; octave *= 2.0) {
    const auto lag = whole_number<std::size_t>(std::round((half ? 1.0 : 0.5) / (std::sqrt(2.0) * octave)));
    std::vector<double> product(length, 0.0);
    for (std::size_t i = n / 10 + lag + 1; i < n; ++i)
      product[i] = residual[i] * (signal[i - lag + 1] - signal[i - lag - 1]);
    const auto bins = half_spectrum(product);
    const auto sine = [&](std::size_t k) {
      k %= length;
      return k < bins.size() ? -bins[k].imag() : bins[length - k].imag();
    };
    const double end = std::min(2.0 * octave, kFastestClock) * static_cast<double>(length);
    for (auto k = whole_number<std::size_t>(std::ceil(std::max(low, octave) * static_cast<double>(length)));
         static_cast<double>(k) < end; ++k) {
      const double sum = (half ? -1.0 : 1.0) * (sine(k) + sine(3 * k) / 3.0) + 0.5 * sine(2 * k);
      if (sum > 0.0) found.emplace_back(sum, static_cast<double>(k) / static_cast<double>(length));
    }
  }
  keep_best(found, 1.0 / static_cast<double>(n), 4 * kMostFound);
  return found;
}

/// Clocks whose stairs of a signal the residual is like, best first; above 0: lag and all, around `guess_hz`.
Starts clocks_of_stairs(const Scene& scene, std::vector<double> signal, const std::vector<double>& residual,
                        bool half, double guess_hz) {
  signal.push_back(signal.back());
  const double h = scene.step_s;
  const bool with_lag = guess_hz > 0.0;
  const auto likeness = [&](double f, std::size_t n) {
    return likeness_to_stairs(signal, residual, half, with_lag, f * h, n / 10, n);
  };
  const std::size_t last = residual.size();
  std::size_t length = std::min(last, kFirstLook);
  const double low_hz =
      with_lag ? 0.5 * guess_hz : std::max(1.5 * scene.band_hz, 8.0 / (static_cast<double>(length) * h));
  const double high_hz = with_lag ? 2.2 * guess_hz : kFastestClock / h;
  double spacing = 1.0 / (kFinerClocks * static_cast<double>(length) * h);
  std::vector<ScoredClock> scored;
  const double one_by_one_hz = with_lag ? high_hz : std::min(high_hz, kFastClock / h);
  for (double f = low_hz; f < one_by_one_hz; f += spacing) scored.emplace_back(likeness(f, length), f);
  if (!with_lag) {
    for (const auto& [sum, clock] : likely_fast_clocks(signal, residual, half, low_hz * h, length))
      scored.emplace_back(likeness(clock / h, length), clock / h);
  }
  for (bool finely = false;; finely = true) {
    keep_best(scored, 1.0 / (static_cast<double>(length) * h));
    if (finely && length == last) return starts_of(scored);
    length = std::min(last, 2 * length);
    std::vector<ScoredClock> finer;
    for (const auto& [size, f] : scored) {
      for (int k = -kFinerClocks; k <= kFinerClocks; ++k) {
        const double g = f + 0.25 * k * spacing;
        finer.emplace_back(likeness(g, length), g);
      }
    }
    scored = std::move(finer);
    spacing *= 0.5;
  }
}

/// Mean square of the measured output less the model's, `lag` samples later.
double distance_at_lag(const Scene& scene, std::size_t lag) {
  const auto& y = scene.boundary.back().values;
  double sum = 0.0;
  for (std::size_t i = lag; i < y.size(); ++i) {
    const double e = y[i] + scene.residual[i] - y[i - lag];
    sum += e * e;
  }
  return sum / static_cast<double>(y.size() - lag);
}

/// Less than a sample or two: from the residual's likeness to the slope.
double lag_by_slope_s(const Scene& scene) {
  const auto& y = scene.boundary.back().values;
  double rs = 0.0;
  double ss = 0.0;
  for (std::size_t i = 1; i + 1 < y.size(); ++i) {
    const double slope = (y[i + 1] - y[i - 1]) / (2.0 * scene.step_s);
    rs -= scene.residual[i] * slope;
    ss += slope * slope;
  }
  return ss > 0.0 ? std::max(0.0, rs / ss) : 0.0;
}

}  // namespace

double mean_lag_s(const Scene& scene) {
  std::size_t best = 0;
  double min_distance = distance_at_lag(scene, 0);
  const auto cycle = whole_number<std::size_t>(1.0 / (scene.band_hz * scene.step_s)) + 2;
  const auto max_lag = std::min(scene.residual.size() / 8, cycle);
  for (std::size_t lag = 1; lag <= max_lag; ++lag) {
    const double d = distance_at_lag(scene, lag);
    if (d < min_distance) {
      min_distance = d;
      best = lag;
    }
  }
  return best < 2 ? lag_by_slope_s(scene) : static_cast<double>(best) * scene.step_s;
}

Starts clocks_of_hold(const Scene& scene, std::size_t at, bool half, double guess_hz, const RedNoise& noise) {
  const bool white = noise.driving_variance > 0.0;
  chain::Chain behind = scene.model->linear_part(at);
  if (behind.blocks.empty() && !white)
    return clocks_of_stairs(scene, scene.boundary[at].values, scene.residual, half, guess_hz);
  // <W r, W H stairs> = <H* W* W r, stairs>, W the filter that makes the residual white: what is behind runs once, from its end.
  std::vector<double> turned = scene.residual;
  if (white) whiten(turned, noise);
  std::reverse(turned.begin(), turned.end());
  if (white) whiten(turned, noise);
  simulate::RecordSimulator simulator(std::move(behind), scene.step_s);
  const auto rest = simulator.run(std::vector<double>(turned.size(), 0.0));
  const std::vector<double> constant(rest.begin(), rest.end());
  const auto y = simulator.run(turned);
  std::vector<double> seen(y.rbegin(), y.rend());
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] -= constant[seen.size() - 1 - i];
  return clocks_of_stairs(scene, scene.boundary[at].values, seen, half, guess_hz);
}

}  // namespace bodesmith::gap
