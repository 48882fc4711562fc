#include "gap/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search_options.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/record/record_simulator.hpp"

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

/// Frequencies of the largest peaks of a spectrum, well apart.
std::vector<double> largest_peaks(const Periodogram& e) {
  std::vector<double> smooth(e.power.size(), 0.0);
  for (std::size_t k = 2; k + 2 < e.power.size(); ++k) {
    for (std::size_t j = k - 2; j <= k + 2; ++j) smooth[k] += e.power[j];
  }
  std::vector<double> found;
  while (found.size() < kMostFound) {
    const auto at = std::max_element(smooth.begin(), smooth.end());
    if (!(*at > 0.0)) break;
    const auto k = static_cast<std::size_t>(at - smooth.begin());
    found.push_back(e.bin_hz * static_cast<double>(k));
    for (std::size_t j = k - k / 5; j <= std::min(smooth.size() - 1, k + k / 5); ++j) smooth[j] = 0.0;
    if (k < 5) break;
  }
  return found;
}

/// Where the input has its power, but for less than a name must explain of energy on each side.
void find_band(Scene& scene, const TimeRecord& record) {
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
    if (scene.low_hz == 0.0 && sum >= kLeastShare * total) scene.low_hz = hz;
    if (scene.band_hz == 0.0 && sum >= (1.0 - kLeastShare) * total) scene.band_hz = hz;
  }
  if (scene.low_hz == 0.0) scene.low_hz = p.bin_hz;
}

Scene scene_of(const Model& model, const TimeExperiment& experiment) {
  const auto& record = experiment.record();
  Scene scene;
  scene.model = &model;
  scene.step_s = record.step_s;
  scene.duration_s = record.duration_s();
  scene.top_hz = 0.5 / record.step_s;
  simulate::RecordOptions options;
  options.start_s = record.start_s;
  options.oversample = experiment.holds();
  simulate::RecordSimulator simulator(with_lines_of(model, experiment).chain(), record.step_s, options);
  for (std::size_t blocks = 0; blocks <= model.size(); ++blocks) {
    scene.boundary.push_back(signal_of(simulator.run_until(record.u, blocks), record.step_s));
  }
  const auto& output = scene.boundary.back().values;
  scene.residual.resize(record.size());
  for (std::size_t i = 0; i < record.size(); ++i) scene.residual[i] = record.y[i] - output[i];
  return scene;
}

/// The record of which most is left, and how far and how fast the signals go in all of them.
Scene scene_of(const Model& model, const Experiments& train) {
  std::vector<Scene> scenes;
  std::size_t at = 0;
  double most = -1.0;
  for (const auto& e : train) {
    const auto& experiment = std::get<TimeExperiment>(e);
    scenes.push_back(scene_of(model, experiment));
    const double left = rms(experiment.scored_part(scenes.back().residual));
    if (!(left > most)) continue;
    most = left;
    at = scenes.size() - 1;
  }
  Scene scene = std::move(scenes[at]);
  const auto& record = std::get<TimeExperiment>(train[at]).record();
  find_band(scene, record);
  scene.residual_peaks_hz = largest_peaks(periodogram(scene.residual, record.step_s));
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    if (k == at) continue;
    for (std::size_t i = 0; i < scene.boundary.size(); ++i)
      scene.boundary[i].add_range_of(scenes[k].boundary[i]);
  }
  return scene;
}

Scene scene_of(const Model& model, const FrequencyExperiment& experiment) {
  Scene scene;
  scene.model = &model;
  scene.frequency_only = true;
  scene.frequency = experiment.record().frequency;
  scene.low_hz = scene.frequency.front().value;
  scene.top_hz = scene.frequency.back().value;
  scene.band_hz = scene.frequency[scene.frequency.size() / 2].value;
  scene.duration_s = 1.0 / scene.low_hz;
  scene.step_s = 0.5 / scene.top_hz;
  return scene;
}

}  // namespace

double Signal::size() const {
  return std::max({std::abs(low), std::abs(high), 1e-300});
}

void Signal::add_range_of(const Signal& other) {
  low = std::min(low, other.low);
  high = std::max(high, other.high);
  sorted_slopes.insert(sorted_slopes.end(), other.sorted_slopes.begin(), other.sorted_slopes.end());
  std::sort(sorted_slopes.begin(), sorted_slopes.end());
}

double Signal::slope_quantile(double q) const {
  if (sorted_slopes.empty()) return 1.0;
  return sorted_slopes[static_cast<std::size_t>(q * static_cast<double>(sorted_slopes.size() - 1))];
}

std::vector<std::size_t> Scene::linear_places() const {
  std::vector<std::size_t> places;
  // The last boundary of every stretch of linear blocks (all of them stand for the same model).
  for (std::size_t i = 0; i <= end(); ++i) {
    if (i == end() || !model->is_linear(i)) places.push_back(i);
  }
  return places;
}

std::vector<std::size_t> Scene::static_places() const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i <= end(); ++i) {
    if (i == end() || !model->at(i).scales_only()) places.push_back(i);
  }
  return places;
}

std::vector<std::size_t> Scene::base_places() const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < model->size(); ++i) {
    if (model->is_base(i)) places.push_back(i);
  }
  return places;
}

Scene make_scene(const Model& model, const Experiments& train) {
  const auto* response = std::get_if<FrequencyExperiment>(&train.front());
  auto scene = response != nullptr ? scene_of(model, *response) : scene_of(model, train);
  scene.records = train.size();
  return scene;
}

}  // namespace bodesmith::gap
