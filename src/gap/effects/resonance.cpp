#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/effects/modes.hpp"

namespace bodesmith::gap {
namespace {

void propose_resonance(const Scene& scene, std::vector<Proposal>& out) {
  Starts starts;
  for (double hz : mode_frequencies_hz(scene, {0.6, 1.2, 2.0, 3.5, 6.0})) {
    for (double damping : {0.05, 0.4}) starts.push_back({hz, damping});
    if (scene.frequency_only) starts.push_back({hz, 0.01});
  }
  if (starts.empty()) return;
  // Above what is sampled it is a lag.
  const double high = (scene.frequency_only ? 3.0 : 1.0) * scene.top_hz;
  for (std::size_t at : scene.linear_places()) {
    auto block = chain::make_block("resonator");
    block.set("gain", 1.0);
    out.push_back(insert_block(scene, at, block,
                               {logarithmic_unknown("natural_frequency_hz", 0.05 * scene.low_hz, high),
                                logarithmic_unknown("damping_ratio", 1e-3, kMostDamping)},
                               starts));
  }
}

bool resonance_is_no_name(const Model&, const Term& term, const Scene&) {
  return !(term.unknowns[1].value < kMostDamping);
}

}  // namespace

BODESMITH_EFFECT(resonance, .what = "a second-order mode",
                 .experiment = "a sweep through the suspected frequency", .linear = true,
                 .repeatable_in_response = true, .of_no_circuit = true, .propose = propose_resonance,
                 .is_no_name = resonance_is_no_name)

}  // namespace bodesmith::gap
