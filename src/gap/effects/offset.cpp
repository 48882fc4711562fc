#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Through a linear stretch a constant is the same wherever it enters, once what it sets going at the first sample is
/// over; of a record from rest each dynamic block behind it shows another start.
std::vector<std::size_t> places(const Scene& scene) {
  return scene.model->chain().start == chain::Start::equilibrium ? scene.linear_places()
                                                                 : scene.static_places();
}

void propose_offset(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : places(scene)) {
    const double size = scene.boundary[at].size();
    out.push_back(insert_block(scene, at, chain::make_block("gain").set("gain", 1.0),
                               {linear_unknown("offset", -10.0 * size, 10.0 * size, 0.1 * size)}));
  }
}

}  // namespace

BODESMITH_EFFECT(
    offset, .what = "a constant is added",
    .experiment = "the same drive at two amplitudes: an offset stays, a curvature grows with the square",
    .propose = propose_offset)

}  // namespace bodesmith::gap
