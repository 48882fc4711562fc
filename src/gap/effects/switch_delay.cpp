#include <algorithm>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_switch_delay(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : places_of_unused(scene, "switch_delay_s")) {
    const double step = scene.step_s;
    // Every turn moves with the delay across samples, so the sum of squares is hilly: a comb over what is possible, a
    // sample apart as long as that is a small part of the delay.
    Starts starts;
    for (double delay = 0.5 * step; delay < 0.4 / scene.low_hz; delay += step) starts.push_back({delay});
    if (starts.empty()) starts.push_back({0.5 * step});
    auto delay = logarithmic_unknown("switch_delay_s", 0.01 * step, 0.5 / scene.low_hz);
    delay.hop = 0.1 * step;
    out.push_back(change_block(scene, at, {delay}, starts));
  }
}

}  // namespace

BODESMITH_EFFECT(
    switch_delay, .what = "the branch switch acts late",
    .experiment = "a fast and a slow triangle: the wrong stretch after a turn lasts the same time in both",
    .propose = propose_switch_delay)

}  // namespace bodesmith::gap
