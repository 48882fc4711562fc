#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class DeadZone final : public Effect {
 public:
  DeadZone()
      : Effect({.name = "dead_zone",
                .what = "no response near zero",
                .experiment = "a small drive around zero: a dead zone passes nothing"}) {}
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    for (std::size_t at : scene.static_places()) {
      const auto& signal = scene.boundary[at];
      const double size = signal.size();
      out.push_back(insert_block(scene, *this, at, chain::make_block("dead_zone"),
                                 {logarithmic_unknown("width", 1e-5 * size, 2.0 * size)},
                                 {{0.01 * size}, {0.06 * size}, {0.25 * size}}));
    }
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, dead_zone_effect, DeadZone)

}  // namespace bodesmith::gap
