#include <algorithm>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A signal that is so rarely within the zone, or on its other side, has not shown it.
constexpr double kRarely = 0.02;

class DeadZone final : public Effect {
 public:
  DeadZone()
      : Effect({.name = "dead_zone",
                .what = "no response near zero",
                .experiment = "a small drive around zero: a dead zone passes nothing"}) {}
  /// Of a signal that stays on one side it takes off a constant.
  bool is_implausible(const Model& model, const Scene& scene) const override {
    const auto at = model.position_of(model.terms().back().blocks.front());
    if (scene.frequency_only || at >= scene.boundary.size()) return false;
    const double edge = 0.5 * model.at(at).get("width");
    double above = 0.0;
    double below = 0.0;
    const auto& values = scene.boundary[at].values;
    for (double v : values) {
      if (v > edge) above += 1.0;
      if (v < -edge) below += 1.0;
    }
    return std::max(above, below) > (1.0 - kRarely) * static_cast<double>(values.size());
  }
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
