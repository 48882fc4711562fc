#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Quantile of the measured output's slope, taken over five samples so that noise does not make it.
double measured_slope(const Scene& scene, double q) {
  const auto& y = scene.boundary.back().values;
  std::vector<double> slopes;
  for (std::size_t i = 5; i < y.size(); ++i) {
    slopes.push_back(std::abs(y[i] + scene.residual[i] - y[i - 5] - scene.residual[i - 5]) /
                     (5.0 * scene.step_s));
  }
  return quantile(std::move(slopes), q);
}

void propose_slew_limit(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    const auto& signal = scene.boundary[at];
    const double fastest = signal.slope_quantile(1.0);
    if (!(fastest > 0.0)) continue;
    Starts starts;
    // What the measured output's straight ramps show, brought to this place by the ratio of sizes.
    const double ratio = signal.span() / std::max(scene.boundary.back().span(), 1e-300);
    for (double q : {0.9, 0.97, 0.995}) {
      const double rate = ratio * measured_slope(scene, q);
      if (rate > 1e-3 * fastest && rate < fastest) starts.push_back({rate});
    }
    for (double rate : {0.9 * fastest, 0.6 * fastest, 0.3 * fastest, 0.1 * fastest,
                        signal.slope_quantile(0.95), signal.slope_quantile(0.8)}) {
      starts.push_back({std::max(rate, 1e-3 * fastest)});
    }
    const auto rate = logarithmic_unknown("rate_per_s", 1e-4 * fastest, 2.0 * fastest);
    out.push_back(insert_block(scene, at, chain::make_block("slew_limit"), {rate}, starts));
    // The same with what an edge sends past the slewing stage.
    for (auto& start : starts) start.push_back(0.03);
    out.push_back(insert_block(scene, at, chain::make_block("slew_limit"),
                               {rate, linear_unknown("feedthrough", 0.0, 0.5, 0.05)}, starts));
  }
}

}  // namespace

BODESMITH_EFFECT(slew_limit, .what = "the rate of change is limited",
                 .experiment = "the same step at two amplitudes: the ramp's slope stays",
                 .propose = propose_slew_limit)

}  // namespace bodesmith::gap
