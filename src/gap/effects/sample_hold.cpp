#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"
#include "gap/experiment.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/record_simulator.hpp"

namespace bodesmith::gap {
namespace {

/// Delay that would explain most of the residual, in seconds; 0 when that is next to nothing.
double mean_lag(const Scene& scene) {
  const auto& y = scene.boundary.back().values;
  const std::size_t n = y.size();
  const auto distance = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) {
      const double e = y[i] + scene.residual[i] - y[i - lag];
      sum += e * e;
    }
    return sum / static_cast<double>(n - lag);
  };
  const double none = distance(0);
  std::size_t best = 0;
  double least = none;
  const auto most =
      std::min<std::size_t>({n / 8, 400, static_cast<std::size_t>(1.0 / (scene.band_hz * scene.step_s)) + 2});
  for (std::size_t lag = 1; lag <= most; ++lag) {
    const double d = distance(lag);
    if (d < least) {
      least = d;
      best = lag;
    }
  }
  if (best >= 2) return least < 0.96 * none ? static_cast<double>(best) * scene.step_s : 0.0;
  // Less than a sample or two: from the residual's likeness to the slope.
  double rs = 0.0;
  double ss = 0.0;
  double rr = 0.0;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double slope = (y[i + 1] - y[i - 1]) / (2.0 * scene.step_s);
    rs -= scene.residual[i] * slope;
    ss += slope * slope;
    rr += scene.residual[i] * scene.residual[i];
  }
  return ss > 0.0 && rs > 0.0 && rs * rs > 0.02 * ss * rr ? rs / ss : 0.0;
}

/// The staircase needs the clock to within a fraction of a cycle over the record. So the search begins with a
/// few hundred samples, where a coarse comb of clocks will do, and refines the best ones as the look grows
/// longer.
std::vector<std::vector<double>> clocks(const Scene& scene, const Model& model, double guess) {
  TimeRecord record;
  record.step_s = scene.step_s;
  record.start_s = scene.start_s;
  record.u = scene.boundary.front().values;
  record.y = scene.boundary.back().values;
  for (std::size_t i = 0; i < record.y.size(); ++i) record.y[i] += scene.residual[i];
  auto values = current_values(model);
  std::vector<double> out;
  std::vector<double> candidates;
  const std::size_t first = std::min<std::size_t>(record.size(), 800);
  double spacing = 0.25 / (static_cast<double>(first) * scene.step_s);
  for (double f = 0.5 * guess; f < 2.2 * guess; f += spacing) candidates.push_back(f);
  for (std::size_t length = first;; length = std::min(record.size(), 2 * length)) {
    TimeExperiment look(record);
    look.set_to(length);
    look.set_skip(length / 5);
    Runner runner(model, {&look});
    std::vector<std::pair<double, double>> scored;
    for (double f : candidates) {
      values.back() = f;
      if (runner(values, out)) scored.emplace_back(rms(out), f);
    }
    std::sort(scored.begin(), scored.end());
    if (scored.size() > 4) scored.resize(4);
    if (length == record.size() || length >= 12800) {
      std::vector<std::vector<double>> starts;
      for (const auto& [size, f] : scored) starts.push_back({f});
      return starts;
    }
    candidates.clear();
    for (const auto& [size, f] : scored) {
      for (int k = -4; k <= 4; ++k) candidates.push_back(f + 0.25 * k * spacing);
    }
    spacing *= 0.5;
  }
}

/// Whether the residual's spectrum above the input's band is anything but flat, as images of a clock make it.
bool images_stand_out(const Scene& scene) {
  const auto p = periodogram(scene.residual, scene.step_s);
  constexpr std::size_t kReach = 4;
  std::vector<double> smooth;
  for (std::size_t k = kReach; k + kReach < p.power.size(); ++k) {
    if (p.bin_hz * static_cast<double>(k) < 1.5 * scene.band_hz) continue;
    double sum = 0.0;
    for (std::size_t j = k - kReach; j <= k + kReach; ++j) sum += p.power[j];
    smooth.push_back(sum);
  }
  // White noise: 2.3.
  constexpr double kUneven = 2.7;
  return smooth.size() < 20 || quantile(smooth, 0.95) > kUneven * quantile(smooth, 0.2);
}

/// Clocks by the staircase alone: the residual is likened to what a hold of the model's output leaves beside
/// its mean lag, which free corners of the model may have taken over. A comb over all clocks on the first
/// samples, the best refined as the look grows longer.
std::vector<std::vector<double>> clocks_by_stairs(const Scene& scene, bool half) {
  const auto& y = scene.boundary.back().values;
  const double h = scene.step_s;
  const auto likeness = [&](double clock, std::size_t from, std::size_t n) {
    const double cycle = 1.0 / (clock * h);  // in samples
    const double late = half ? 0.5 * cycle : 0.0;
    const double lag = 0.5 * cycle + late;
    double along = 0.0;
    double size = 0.0;
    for (std::size_t i = from; i < n; ++i) {
      const auto t = static_cast<double>(i);
      const double edge = std::floor((t - late) / cycle) * cycle;
      const double mean = t - lag;
      if (edge < 0.0 || mean < 0.0) continue;
      const auto at = [&](double s) {
        const auto k = static_cast<std::size_t>(s);
        return k + 1 < n ? y[k] + (s - static_cast<double>(k)) * (y[k + 1] - y[k]) : y[k];
      };
      const double feature = at(edge) - at(mean);
      along += scene.residual[i] * feature;
      size += feature * feature;
    }
    return along > 0.0 && size > 0.0 ? along * along / size : 0.0;
  };
  const std::size_t most = std::min<std::size_t>(y.size(), 16000);
  std::size_t length = std::min<std::size_t>(most, 2500);
  double spacing = 0.2 / (static_cast<double>(length) * h);
  std::vector<std::pair<double, double>> scored;
  for (double f = std::max(1.5 * scene.band_hz, 8.0 / (static_cast<double>(length) * h)); f < 0.7 / h;
       f += spacing)
    scored.emplace_back(likeness(f, length / 10, length), f);
  while (true) {
    std::sort(scored.rbegin(), scored.rend());
    if (scored.size() > 4) scored.resize(4);
    if (length == most) break;
    length = std::min(most, 2 * length);
    std::vector<std::pair<double, double>> finer;
    for (const auto& [size, f] : scored) {
      for (int k = -4; k <= 4; ++k) {
        const double g = f + 0.25 * k * spacing;
        finer.emplace_back(likeness(g, length / 10, length), g);
      }
    }
    scored = std::move(finer);
    spacing *= 0.5;
  }
  std::vector<std::vector<double>> starts;
  for (const auto& [size, f] : scored) {
    if (size > 0.0) starts.push_back({f});
  }
  return starts;
}

bool dynamics_follow(const Scene& scene, std::size_t at) {
  for (std::size_t k = at; k < scene.model->size(); ++k) {
    const auto type = scene.model->at(k).type_name();
    if (type == "lowpass" || type == "resonator" || type == "pole_zero") return true;
  }
  return false;
}

/// The same for a hold in front of dynamics, which soften its stairs: the feature is what the whole model
/// makes of a hold beside a plain delay of the same mean, on the first samples.
std::vector<std::vector<double>> clocks_behind_dynamics(const Scene& scene, std::size_t at, bool half) {
  Model held = *scene.model;
  auto hold = chain::make_block("sample_hold").set("half_cycle", half ? 1.0 : 0.0);
  const int hold_id = held.insert(at, hold.set("clock_hz", 1.0 / scene.step_s));
  Model late = *scene.model;
  const int delay_id = late.insert(at, chain::make_block("delay").set("delay_s", scene.step_s));
  const std::size_t n = std::min<std::size_t>(scene.residual.size(), 800);
  const auto u = std::span<const double>(scene.boundary.front().values).first(n);
  simulate::RecordOptions options;
  options.start_s = scene.start_s;
  simulate::RecordSimulator with_hold(held.chain(), scene.step_s, options);
  simulate::RecordSimulator with_delay(late.chain(), scene.step_s, options);
  auto& hold_block = with_hold.chain().blocks[held.position_of(hold_id)];
  auto& delay_block = with_delay.chain().blocks[late.position_of(delay_id)];
  std::vector<std::pair<double, double>> scored;
  const double spacing = 0.25 / (static_cast<double>(n) * scene.step_s);
  for (double f = 1.5 * scene.band_hz; f < 0.25 / scene.step_s; f += spacing) {
    hold_block.set("clock_hz", f);
    delay_block.set("delay_s", (half ? 1.0 : 0.5) / f);
    const auto a = with_hold.run(u);
    const auto b = with_delay.run(u);
    double along = 0.0;
    double size = 0.0;
    for (std::size_t i = n / 10; i < n; ++i) {
      along += scene.residual[i] * (a[i] - b[i]);
      size += (a[i] - b[i]) * (a[i] - b[i]);
    }
    scored.emplace_back(along > 0.0 && size > 0.0 ? along * along / size : 0.0, f);
  }
  std::sort(scored.rbegin(), scored.rend());
  std::vector<std::vector<double>> starts;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, scored.size()); ++k) {
    if (scored[k].first > 0.0) starts.push_back({scored[k].second});
  }
  return starts;
}

class SampleHold final : public Effect {
 public:
  std::string_view name() const override { return "sample_hold"; }
  std::string_view what() const override { return "a clocked hold: droop and half a cycle of delay"; }
  std::string_view tell_tale() const override {
    return "a staircase: a residual that repeats with the clock";
  }
  std::vector<std::string_view> confused_with() const override { return {"time_delay", "amplifier_pole"}; }
  bool linear() const override { return true; }
  bool starts_from_residual() const override { return true; }
  std::string_view experiment() const override {
    return "a faster clock, or a record sampled much faster than it";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) {
      for (std::size_t at : scene.linear_places()) {
        for (bool half : {false, true}) {
          auto block = chain::make_block("sample_hold");
          block.set("half_cycle", half ? 1.0 : 0.0);
          std::vector<std::vector<double>> starts;
          for (double factor : {1.2, 2.5, 6.0, 20.0}) starts.push_back({factor * scene.top_hz});
          block.set("clock_hz", starts[0][0]);
          out.push_back(insert_block(
              scene, *this, at, block,
              {logarithmic_unknown("clock_hz", 0.6 * scene.top_hz, 1e3 * scene.top_hz)}, starts));
        }
      }
      return;
    }
    // A held signal lags by half a clock on the average; that, and the staircase itself, tell the clock.
    const double lag = mean_lag(scene);
    const bool images = images_stand_out(scene);
    if (!images && !(lag > 0.05 * scene.step_s)) return;
    std::array<std::vector<std::vector<double>>, 2> stairs;
    for (bool half : {false, true}) {
      if (images) stairs[half ? 1 : 0] = clocks_by_stairs(scene, half);
    }
    for (std::size_t at : scene.static_places()) {
      for (bool half : {false, true}) {
        auto starts = stairs[half ? 1 : 0];
        if (images && at < scene.model->size() && dynamics_follow(scene, at)) {
          const auto more = clocks_behind_dynamics(scene, at, half);
          starts.insert(starts.begin(), more.begin(), more.end());
        }
        auto block = chain::make_block("sample_hold");
        block.set("half_cycle", half ? 1.0 : 0.0);
        if (lag > 0.05 * scene.step_s) {
          const double guess = std::clamp((half ? 1.0 : 0.5) / lag, 0.5 * scene.band_hz, 1.0 / scene.step_s);
          block.set("clock_hz", guess);
          const auto p = insert_block(scene, *this, at, block,
                                      {logarithmic_unknown("clock_hz", 0.2 * guess, 5.0 * guess)}, {{guess}});
          const auto more = clocks(scene, p.model, guess);
          starts.insert(starts.end(), more.begin(), more.end());
        }
        if (starts.empty()) continue;
        double low = starts[0][0];
        double high = low;
        for (const auto& start : starts) {
          low = std::min(low, start[0]);
          high = std::max(high, start[0]);
        }
        block.set("clock_hz", starts[0][0]);
        out.push_back(insert_block(scene, *this, at, block,
                                   {logarithmic_unknown("clock_hz", 0.5 * low, 2.0 * high)}, starts));
      }
    }
  }
};

}  // namespace

const Effect& sample_hold_effect() {
  static const SampleHold effect;
  return effect;
}

}  // namespace bodesmith::gap
