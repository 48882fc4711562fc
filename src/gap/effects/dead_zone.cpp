#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_dead_zone(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    const auto& signal = scene.boundary[at];
    const double size = signal.size();
    out.push_back(insert_block(scene, at, chain::make_block("dead_zone"),
                               {logarithmic_unknown("width", 1e-5 * size, 2.0 * size)},
                               {{0.01 * size}, {0.06 * size}, {0.25 * size}}));
  }
}

}  // namespace

BODESMITH_EFFECT(dead_zone, .what = "no response near zero",
                 .experiment = "a small drive around zero: a dead zone passes nothing", .static_curve = true,
                 .propose = propose_dead_zone)

}  // namespace bodesmith::gap
