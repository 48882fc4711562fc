#include "gap/effects/sample_hold_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "chain/registry.hpp"
#include "gap/runner.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/record_simulator.hpp"

namespace bodesmith::gap {
namespace {

/// Clocks kept at each length of the look, and new ones on either side of each in the next.
constexpr std::size_t kKept = 4;
constexpr int kFiner = 4;
/// Samples of the first look (stairs: of theirs), and of the last one.
constexpr std::size_t kFirstLook = 800;
constexpr std::size_t kFirstStairs = 2500;
constexpr std::size_t kLastLook = 12800;
constexpr std::size_t kLastStairs = 16000;
/// A lag of whole samples must leave less than this of the mean square, one below a sample must explain that
/// share.
constexpr double kMaxLeftByLag = 0.96;
constexpr double kMinSlopeShare = 0.02;
constexpr std::size_t kMaxLagSamples = 400;

/// A figure of merit and the clock it belongs to, Hz.
using ScoredClock = std::pair<double, double>;

Starts starts_of(const std::vector<ScoredClock>& scored) {
  Starts starts;
  for (const auto& [size, f] : scored) {
    if (size > 0.0) starts.push_back({f});
  }
  return starts;
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

/// Likeness of the residual's samples `from` … n - 1 to stairs of the output less their mean lag.
double likeness_to_stairs(const Scene& scene, bool half, double clock_hz, std::size_t from, std::size_t n) {
  const auto& y = scene.boundary.back().values;
  const double cycle = 1.0 / (clock_hz * scene.step_s);  // in samples
  const double late = half ? 0.5 * cycle : 0.0;
  const double lag = 0.5 * cycle + late;
  const auto at = [&](double s) {
    const auto k = static_cast<std::size_t>(s);
    return k + 1 < n ? y[k] + (s - static_cast<double>(k)) * (y[k + 1] - y[k]) : y[k];
  };
  Likeness likeness;
  for (std::size_t i = from; i < n; ++i) {
    const auto t = static_cast<double>(i);
    const double edge = std::floor((t - late) / cycle) * cycle;
    const double mean = t - lag;
    if (edge < 0.0 || mean < 0.0) continue;
    likeness.add(scene.residual[i], at(edge) - at(mean));
  }
  return likeness.value();
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
  double rr = 0.0;
  for (std::size_t i = 1; i + 1 < y.size(); ++i) {
    const double slope = (y[i + 1] - y[i - 1]) / (2.0 * scene.step_s);
    rs -= scene.residual[i] * slope;
    ss += slope * slope;
    rr += scene.residual[i] * scene.residual[i];
  }
  return ss > 0.0 && rs > 0.0 && rs * rs > kMinSlopeShare * ss * rr ? rs / ss : 0.0;
}

}  // namespace

double mean_lag_s(const Scene& scene) {
  const double none = distance_at_lag(scene, 0);
  std::size_t best = 0;
  double min_distance = none;
  const auto cycle = static_cast<std::size_t>(1.0 / (scene.band_hz * scene.step_s)) + 2;
  const auto max_lag = std::min<std::size_t>({scene.residual.size() / 8, kMaxLagSamples, cycle});
  for (std::size_t lag = 1; lag <= max_lag; ++lag) {
    const double d = distance_at_lag(scene, lag);
    if (d < min_distance) {
      min_distance = d;
      best = lag;
    }
  }
  if (best < 2) return lag_by_slope_s(scene);
  return min_distance < kMaxLeftByLag * none ? static_cast<double>(best) * scene.step_s : 0.0;
}

bool images_stand_out(const Scene& scene) {
  constexpr std::size_t kReach = 4;
  constexpr double kUneven = 2.7;  // white noise: 2.3
  const auto p = periodogram(scene.residual, scene.step_s);
  std::vector<double> smooth;
  for (std::size_t k = kReach; k + kReach < p.power.size(); ++k) {
    if (p.bin_hz * static_cast<double>(k) < 1.5 * scene.band_hz) continue;
    double sum = 0.0;
    for (std::size_t j = k - kReach; j <= k + kReach; ++j) sum += p.power[j];
    smooth.push_back(sum);
  }
  return smooth.size() < 20 || quantile(smooth, 0.95) > kUneven * quantile(smooth, 0.2);
}

Starts clocks_by_lag(const Scene& scene, const Model& held, double guess_hz) {
  TimeRecord record;
  record.step_s = scene.step_s;
  record.start_s = scene.start_s;
  record.u = scene.boundary.front().values;
  for (std::size_t i = 0; i < record.u.size(); ++i) record.y.push_back(scene.measured(i));
  const std::size_t size = record.size();
  TimeExperiment look(std::move(record));
  auto values = current_values(held);
  std::vector<double> residual;
  std::vector<double> candidates;
  const std::size_t first = std::min(size, kFirstLook);
  double spacing = 0.25 / (static_cast<double>(first) * scene.step_s);
  for (double f = 0.5 * guess_hz; f < 2.2 * guess_hz; f += spacing) candidates.push_back(f);
  for (std::size_t length = first;; length = std::min(size, 2 * length)) {
    look.use(length / 5, length);
    Runner runner(held, {look});
    std::vector<ScoredClock> scored;
    for (double f : candidates) {
      values.back() = f;
      if (runner(values, residual)) scored.emplace_back(rms(residual), f);
    }
    std::sort(scored.begin(), scored.end());
    if (scored.size() > kKept) scored.resize(kKept);
    if (length == size || length >= kLastLook) {
      Starts starts;
      for (const auto& [left, f] : scored) starts.push_back({f});
      return starts;
    }
    candidates.clear();
    for (const auto& [left, f] : scored) {
      for (int k = -kFiner; k <= kFiner; ++k) candidates.push_back(f + 0.25 * k * spacing);
    }
    spacing *= 0.5;
  }
}

Starts clocks_by_stairs(const Scene& scene, bool half) {
  const double h = scene.step_s;
  const std::size_t last = std::min(scene.residual.size(), kLastStairs);
  std::size_t length = std::min(last, kFirstStairs);
  double spacing = 0.2 / (static_cast<double>(length) * h);
  std::vector<ScoredClock> scored;
  for (double f = std::max(1.5 * scene.band_hz, 8.0 / (static_cast<double>(length) * h)); f < 0.7 / h;
       f += spacing)
    scored.emplace_back(likeness_to_stairs(scene, half, f, length / 10, length), f);
  while (true) {
    std::sort(scored.rbegin(), scored.rend());
    if (scored.size() > kKept) scored.resize(kKept);
    if (length == last) return starts_of(scored);
    length = std::min(last, 2 * length);
    std::vector<ScoredClock> finer;
    for (const auto& [size, f] : scored) {
      for (int k = -kFiner; k <= kFiner; ++k) {
        const double g = f + 0.25 * k * spacing;
        finer.emplace_back(likeness_to_stairs(scene, half, g, length / 10, length), g);
      }
    }
    scored = std::move(finer);
    spacing *= 0.5;
  }
}

Starts clocks_before_dynamics(const Scene& scene, std::size_t at, bool half) {
  Model held = *scene.model;
  auto hold = chain::make_block("sample_hold").set("half_cycle", half ? 1.0 : 0.0);
  const int hold_id = held.insert(at, hold.set("clock_hz", 1.0 / scene.step_s));
  Model late = *scene.model;
  const int delay_id = late.insert(at, chain::make_block("delay").set("delay_s", scene.step_s));
  const std::size_t n = std::min(scene.residual.size(), kFirstLook);
  const auto u = std::span<const double>(scene.boundary.front().values).first(n);
  simulate::RecordOptions options;
  options.start_s = scene.start_s;
  simulate::RecordSimulator with_hold(held.chain(), scene.step_s, options);
  simulate::RecordSimulator with_delay(late.chain(), scene.step_s, options);
  auto& hold_block = with_hold.chain().blocks[held.position_of(hold_id)];
  auto& delay_block = with_delay.chain().blocks[late.position_of(delay_id)];
  std::vector<ScoredClock> scored;
  const double spacing = 0.25 / (static_cast<double>(n) * scene.step_s);
  for (double f = 1.5 * scene.band_hz; f < 0.25 / scene.step_s; f += spacing) {
    hold_block.set("clock_hz", f);
    delay_block.set("delay_s", (half ? 1.0 : 0.5) / f);
    const auto a = with_hold.run(u);
    const auto b = with_delay.run(u);
    Likeness likeness;
    for (std::size_t i = n / 10; i < n; ++i) likeness.add(scene.residual[i], a[i] - b[i]);
    scored.emplace_back(likeness.value(), f);
  }
  std::sort(scored.rbegin(), scored.rend());
  if (scored.size() > 3) scored.resize(3);
  return starts_of(scored);
}

}  // namespace bodesmith::gap
