#include "gap/scene.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/record_simulator.hpp"

namespace bodesmith::gap {
namespace {

Signal signal_of(std::span<const double> v, double step_s) {
  Signal s;
  s.values.assign(v.begin(), v.end());
  const auto [low, high] = std::minmax_element(s.values.begin(), s.values.end());
  s.low = *low;
  s.high = *high;
  for (std::size_t i = 1; i < s.values.size(); ++i) {
    s.sorted_slopes.push_back(std::abs(s.values[i] - s.values[i - 1]) / step_s);
  }
  std::sort(s.sorted_slopes.begin(), s.sorted_slopes.end());
  return s;
}

/// Frequencies of the largest peaks of the residual relative to the input's own spectrum, well apart.
std::vector<double> peaks(const Periodogram& e, std::size_t most) {
  std::vector<double> smooth(e.power.size(), 0.0);
  for (std::size_t k = 2; k + 2 < e.power.size(); ++k) {
    for (std::size_t j = k - 2; j <= k + 2; ++j) smooth[k] += e.power[j];
  }
  std::vector<double> found;
  for (std::size_t count = 0; count < most; ++count) {
    const auto at = std::max_element(smooth.begin(), smooth.end());
    if (!(*at > 0.0)) break;
    const auto k = static_cast<std::size_t>(at - smooth.begin());
    found.push_back(e.bin_hz * static_cast<double>(k));
    for (std::size_t j = k - k / 5; j <= std::min(smooth.size() - 1, k + k / 5); ++j) smooth[j] = 0.0;
    if (k < 5) break;
  }
  return found;
}

}  // namespace

Scene make_scene(const Model& model, const Experiments& train) {
  Scene scene;
  scene.model = &model;
  if (const auto* response = dynamic_cast<const FrequencyExperiment*>(train.front())) {
    scene.frequency_only = true;
    const auto& f = response->record().frequency;
    scene.low_hz = f.front().value;
    scene.top_hz = f.back().value;
    scene.band_hz = f[f.size() / 2].value;
    scene.duration_s = 1.0 / scene.low_hz;
    scene.step_s = 0.5 / scene.top_hz;
    const auto e = residuals_of(model, train);
    std::vector<std::pair<double, double>> sizes;
    for (std::size_t i = 0; i < f.size(); ++i)
      sizes.emplace_back(std::hypot(e[2 * i], e[2 * i + 1]), f[i].value);
    std::sort(sizes.rbegin(), sizes.rend());
    for (std::size_t i = 0; i < std::min<std::size_t>(3, sizes.size()); ++i)
      scene.residual_peaks_hz.push_back(sizes[i].second);
    return scene;
  }
  const auto& experiment = dynamic_cast<const TimeExperiment&>(*train.front());
  const auto& record = experiment.record();
  scene.start_s = record.start_s;
  scene.step_s = record.step_s;
  scene.duration_s = record.duration_s();
  scene.top_hz = 0.5 / record.step_s;
  simulate::RecordOptions options;
  options.start_s = record.start_s;
  simulate::RecordSimulator simulator(model.chain(), record.step_s, options);
  for (std::size_t blocks = 0; blocks <= model.size(); ++blocks) {
    scene.boundary.push_back(signal_of(simulator.run_until(record.u, blocks), record.step_s));
  }
  const auto& output = scene.boundary.back().values;
  scene.residual.resize(record.size());
  for (std::size_t i = 0; i < record.size(); ++i) scene.residual[i] = record.y[i] - output[i];

  auto moving = record.u;
  const double middle = mean(moving);
  for (double& v : moving) v -= middle;
  const auto p = periodogram(moving, record.step_s);
  double total = 0.0;
  for (double v : p.power) total += v;
  double sum = 0.0;
  for (std::size_t k = 0; k < p.power.size(); ++k) {
    sum += p.power[k];
    const double hz = p.bin_hz * static_cast<double>(std::max<std::size_t>(k, 1));
    if (scene.low_hz == 0.0 && sum >= 0.05 * total) scene.low_hz = hz;
    if (scene.band_hz == 0.0 && sum >= 0.95 * total) scene.band_hz = hz;
  }
  if (scene.low_hz == 0.0) scene.low_hz = p.bin_hz;
  scene.band_hz = std::max(scene.band_hz, 4.0 * p.bin_hz);
  scene.residual_peaks_hz = peaks(periodogram(scene.residual, record.step_s), 3);
  return scene;
}

std::size_t settling_samples(const chain::Chain& chain, double step_s) {
  double slowest = 0.0;
  for (const auto& block : chain.blocks) {
    const auto type = block.type_name();
    double tau = 0.0;
    if (type == "lowpass") tau = 1.0 / Hertz{block.get("corner_hz")}.rad_s().value;
    if (type == "pole_zero") tau = 1.0 / Hertz{block.get("pole_hz")}.rad_s().value;
    if (type == "resonator") {
      const double w = Hertz{block.get("natural_frequency_hz")}.rad_s().value;
      const double d = block.get("damping_ratio");
      tau = 1.0 / (w * (d < 1.0 ? d : d - std::sqrt(d * d - 1.0)));
    }
    if (type == "fractional_lead_lag") tau = block.get("lambda_s") * std::max(1.0, block.get("x"));
    if (type == "delay") tau = block.get("delay_s") / 7.0;
    if (type == "creep") {
      for (double t : block.list("time_constants_s")) tau = std::max(tau, t);
    }
    slowest = std::max(slowest, tau);
  }
  return static_cast<std::size_t>(std::min(7.0 * slowest / step_s, 1e9));
}

TimeRecord lively_stretch(const TimeRecord& record, std::size_t lead, std::size_t samples) {
  if (record.size() <= lead + samples + samples / 4) return record;
  const double middle = mean(record.y);
  std::vector<double> energy(record.size() + 1, 0.0);
  for (std::size_t i = 0; i < record.size(); ++i) {
    energy[i + 1] = energy[i] + (record.y[i] - middle) * (record.y[i] - middle);
  }
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t from = 0; from + lead + samples <= record.size();
       from += std::max<std::size_t>(1, samples / 8)) {
    const double e = energy[from + lead + samples] - energy[from + lead];
    if (e > 1.02 * most) {
      most = e;
      best = from;
    }
  }
  TimeRecord cut;
  cut.file = record.file;
  cut.step_s = record.step_s;
  cut.start_s = record.time_s(best);
  const auto a = static_cast<std::ptrdiff_t>(best);
  const auto b = static_cast<std::ptrdiff_t>(best + lead + samples);
  cut.u.assign(record.u.begin() + a, record.u.begin() + b);
  cut.y.assign(record.y.begin() + a, record.y.begin() + b);
  return cut;
}

}  // namespace bodesmith::gap
