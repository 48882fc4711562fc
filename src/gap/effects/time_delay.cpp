#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_time_delay(const Scene& scene, std::vector<Proposal>& out) {
  const double step = scene.frequency_only ? 0.02 / scene.top_hz : scene.step_s;
  const double max_delay = scene.frequency_only ? 2.0 / scene.low_hz : 0.1 * scene.duration_s;
  const Starts starts = {{0.3 * step}, {2.0 * step}, {0.05 / scene.band_hz}, {0.15 / scene.band_hz}};
  for (std::size_t at : scene.linear_places()) {
    out.push_back(insert_block(scene, at, chain::make_block("delay"),
                               {logarithmic_unknown("delay_s", 1e-3 * step, max_delay)}, starts));
  }
}

}  // namespace

BODESMITH_EFFECT(time_delay, .what = "the signal arrives later",
                 .experiment = "a sweep to higher frequencies: a pole loses gain, a delay does not",
                 .linear = true, .of_no_circuit = true, .propose = propose_time_delay)

}  // namespace bodesmith::gap
