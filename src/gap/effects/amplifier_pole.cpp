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

}  // namespace

BODESMITH_EFFECT(
    amplifier_pole, .what = "a first-order lag",
    .experiment =
        "a sweep to higher frequencies, and the same step at two amplitudes (a slew limit scales with it, "
        "a pole does not)",
    .linear = true, .repeatable_in_response = true, .of_no_circuit = true, .propose = propose_amplifier_pole)

}  // namespace bodesmith::gap
