#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A capacitor further off is another part.
constexpr double kMaxRatio = 1.5;

class CapacitorMismatch final : public Effect {
 public:
  CapacitorMismatch()
      : Effect({.name = "capacitor_mismatch",
                .what = "a section's pole or zero is shifted by its capacitor ratio",
                .experiment = "the section alone, measured across its corner",
                .linear = true}) {}
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    for (std::size_t at : scene.base_places()) {
      const auto& section = scene.model->at(at);
      if (section.section_order() != 1) continue;
      for (const auto& corner : section.parameters()) {
        if (corner.free || !corner.spec->is_frequency() || !(corner.value > 0.0)) continue;
        const double value = corner.value;
        out.push_back(change_block(scene, *this, at,
                                   {logarithmic_unknown(corner.key(), value / kMaxRatio, value * kMaxRatio)},
                                   {{value * 1.01}}));
      }
    }
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, capacitor_mismatch_effect, CapacitorMismatch)

}  // namespace bodesmith::gap
