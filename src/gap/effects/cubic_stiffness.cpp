#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class CubicStiffness final : public Effect {
 public:
  std::string_view name() const override { return "cubic_stiffness"; }
  std::string_view what() const override { return "a cubic term in a resonator's spring"; }
  std::vector<std::string_view> confused_with() const override {
    return {"cubic_nonlinearity", "saturation", "drag"};
  }
  std::string_view experiment() const override {
    return "sweeps at two amplitudes: a spring moves the resonance, a static curve does not";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : places_of_unused(scene, "cubic")) {
      const double size = scene.boundary[at + 1].size();
      const double scale = 0.1 / std::pow(size, 2);
      out.push_back(change_block(
          scene, *this, at, {linear_unknown("cubic", -8.0 * scale, 8.0 * scale, scale)}, {{0.2 * scale}}));
    }
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, cubic_stiffness_effect, CubicStiffness)

}  // namespace bodesmith::gap
