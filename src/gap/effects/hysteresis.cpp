#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

/// Loops run through in the leading sense have negative weights; six of these still leave the output rising.
constexpr double kLeastWeight = -0.15;

class Hysteresis final : public Effect {
 public:
  std::string_view name() const override { return "hysteresis"; }
  std::string_view what() const override { return "rate-independent memory"; }
  std::string_view tell_tale() const override {
    return "a residual that changes sign with the direction of motion and grows with amplitude";
  }
  std::vector<std::string_view> confused_with() const override {
    return {"backlash", "creep", "time_delay", "rate_dependence"};
  }
  std::string_view experiment() const override {
    return "loops of several amplitudes at two frequencies: memory keeps its loop when the frequency changes";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    // A bank of plays with fixed radii (Prandtl-Ishlinskii): linear in its weights, dense enough for any
    // smooth loop.
    for (std::size_t at : scene.static_places()) {
      const double half = 0.5 * scene.boundary[at].span();
      if (!(half > 0.0)) continue;
      const std::vector<double> parts = {0.04, 0.12, 0.25, 0.42, 0.62, 0.82};
      std::vector<double> radius = {0.0};
      std::vector<double> weight = {1.0};
      std::vector<Unknown> unknowns;
      std::vector<double> start;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        radius.push_back(parts[k] * half);
        weight.push_back(0.01);
        unknowns.push_back(linear_unknown("w[" + std::to_string(k + 1) + "]", kLeastWeight, 5.0, 0.05));
        start.push_back(0.01);
      }
      auto block = chain::make_block("prandtl_ishlinskii");
      block.set("r", radius).set("w", weight);
      out.push_back(insert_block(scene, *this, at, block, unknowns, {start}));
    }
  }
};

}  // namespace

const Effect& hysteresis_effect() {
  static const Hysteresis effect;
  return effect;
}

}  // namespace bodesmith::gap
