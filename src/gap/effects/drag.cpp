#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class Drag final : public Effect {
 public:
  std::string_view name() const override { return "drag"; }
  std::string_view what() const override { return "damping in proportion to |v| v inside a resonator"; }
  std::vector<std::string_view> confused_with() const override { return {"cubic_stiffness"}; }
  std::string_view experiment() const override {
    return "ring-downs from two amplitudes: drag damps the larger one more";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : places_of_unused(scene, "drag")) {
      const auto& block = scene.model->at(at);
      const double size = scene.boundary[at + 1].size();
      // |y'| y' of a signal of size S at the natural frequency is about (w S)^2: as large as a tenth of the
      // damping.
      const double w = Hertz{block.get("natural_frequency_hz")}.rad_s().value;
      const double scale = 0.2 * block.get("damping_ratio") / (w * size);
      out.push_back(change_block(
          scene, *this, at, {linear_unknown("drag", -5.0 * scale, 50.0 * scale, scale)}, {{0.2 * scale}}));
    }
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, drag_effect, Drag)

}  // namespace bodesmith::gap
