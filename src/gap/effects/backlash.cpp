#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_backlash(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    const auto& signal = scene.boundary[at];
    const double span = signal.span();
    out.push_back(insert_block(scene, at, chain::make_block("backlash"),
                               {logarithmic_unknown("width", 1e-5 * span, span)},
                               {{0.005 * span}, {0.03 * span}, {0.12 * span}}));
  }
}

}  // namespace

BODESMITH_EFFECT(
    backlash, .what = "play of constant width",
    .experiment = "loops of two amplitudes at two frequencies: play has one width at all of them",
    .propose = propose_backlash)

}  // namespace bodesmith::gap
