#include <algorithm>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/effects/sample_hold_clocks.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::gap {
namespace {

chain::Block hold_block(bool half, double clock_hz) {
  auto block = chain::make_block("sample_hold");
  block.set("half_cycle", half ? 1.0 : 0.0).set("clock_hz", clock_hz);
  return block;
}

void propose_in_response(const Scene& scene, std::vector<Proposal>& out) {
  Starts starts;
  for (double factor : {1.2, 2.5, 6.0, 20.0}) starts.push_back({factor * scene.top_hz});
  const auto clock = logarithmic_unknown("clock_hz", 0.6 * scene.top_hz, 1e3 * scene.top_hz);
  for (std::size_t at : scene.linear_places()) {
    for (bool half : {false, true})
      out.push_back(insert_block(scene, at, hold_block(half, starts[0][0]), {clock}, starts));
  }
}

/// A held signal lags by half a clock on the average; that, and the staircase itself, tell the clock.
void propose_in_time(const Scene& scene, std::vector<Proposal>& out) {
  const double lag_s = mean_lag_s(scene);
  const std::vector<std::size_t> places = scene.static_places();
  const RedNoise noise = places.empty() ? RedNoise() : most_likely_red_noise({scene.residual});
  std::vector<Starts> found(2 * places.size());  // whole and half cycles of delay
  parallel_for(found.size(), allowed_threads(), [&](std::size_t i) {
    const std::size_t at = places[i / 2];
    const bool half = i % 2 == 1;
    found[i] = clocks_of_hold(scene, at, half);
    const auto add = [&](const Starts& more) { found[i].insert(found[i].end(), more.begin(), more.end()); };
    add(clocks_of_hold(scene, at, half, 0.0, noise));
    if (!(lag_s > 0.0)) return;
    const double guess = std::clamp((half ? 1.0 : 0.5) / lag_s, 0.5 * scene.band_hz, 1.0 / scene.step_s);
    add({{guess}});
    add(clocks_of_hold(scene, at, half, guess));
  });
  for (std::size_t i = 0; i < found.size(); ++i) {
    Starts& starts = found[i];
    // One converter often drives both: clocks of which the sampling is a multiple, as long as a drive could be followed with them.
    for (double cycle = 2.0 * scene.step_s; cycle * scene.band_hz < 0.5; cycle += scene.step_s)
      starts.push_back({1.0 / cycle});
    if (starts.empty()) continue;
    const auto [low, high] = std::minmax_element(starts.begin(), starts.end());
    auto clock = logarithmic_unknown("clock_hz", 0.5 * (*low)[0], 2.0 * (*high)[0]);
    // A tenth of a sample at the record's end.
    clock.hop = 0.1 * starts[0][0] / static_cast<double>(scene.residual.size());
    out.push_back(insert_block(scene, places[i / 2], hold_block(i % 2 == 1, starts[0][0]), {clock}, starts));
  }
}

void propose_sample_hold(const Scene& scene, std::vector<Proposal>& out) {
  if (scene.frequency_only) {
    propose_in_response(scene, out);
  } else {
    propose_in_time(scene, out);
  }
}

}  // namespace

BODESMITH_EFFECT(sample_hold, .what = "a clocked hold: droop and half a cycle of delay",
                 .experiment = "a faster clock, or a record sampled much faster than it", .linear = true,
                 .propose = propose_sample_hold)

}  // namespace bodesmith::gap
