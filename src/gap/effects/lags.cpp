#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_amplifier_pole(const Scene& scene, std::vector<Proposal>& out) {
  const double b = scene.band_hz;
  const Starts starts = {{30.0 * b}, {6.0 * b}, {1.5 * b}, {0.4 * b}};
  const auto corner = logarithmic_unknown("corner_hz", 1e-3 * b, 1e3 * std::max(b, 0.03 * scene.top_hz));
  for (std::size_t at : scene.linear_places())
    out.push_back(insert_block(scene, at, chain::make_block("lowpass"), {corner}, starts));
}

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

BODESMITH_EFFECT(
    amplifier_pole, .what = "a first-order lag",
    .experiment =
        "a sweep to higher frequencies, and the same step at two amplitudes (a slew limit scales with it, "
        "a pole does not)",
    .linear = true, .repeatable_in_response = true, .of_no_circuit = true, .propose = propose_amplifier_pole)

BODESMITH_EFFECT(time_delay, .what = "the signal arrives later",
                 .experiment = "a sweep to higher frequencies: a pole loses gain, a delay does not",
                 .linear = true, .of_no_circuit = true, .propose = propose_time_delay)

}  // namespace bodesmith::gap
