#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A section's capacitors, and op-amps, are effects of their own.
void propose_part_value(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.base_places()) {
    const chain::Block& block = scene.model->at(at);
    for (std::size_t k = 0; block.parts && block.section_order() == 0 && k < block.parts->size(); ++k) {
      if ((*block.parts)[k].noise_gain.empty()) out.push_back(change_part(scene, at, k));
    }
  }
}

}  // namespace

BODESMITH_EFFECT(part_value, .what = "a part of a block is off its value",
                 .experiment = "one end of the part lifted, and the part measured", .places_a_round = 6,
                 .propose = propose_part_value)

}  // namespace bodesmith::gap
