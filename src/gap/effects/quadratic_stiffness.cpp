#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class QuadraticStiffness final : public Effect {
 public:
  std::string_view name() const override { return "quadratic_stiffness"; }
  std::string_view what() const override { return "a quadratic term in a resonator's spring"; }
  std::vector<std::string_view> confused_with() const override {
    return {"offset", "quadratic_nonlinearity"};
  }
  std::string_view experiment() const override {
    return "the same drive with two biases: a quadratic spring moves the resonance with the bias, an offset "
           "does not";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : places_of_unused(scene, "quadratic")) {
      const double size = scene.boundary[at + 1].size();
      const double scale = 0.1 / std::pow(size, 1);
      out.push_back(change_block(scene, *this, at,
                                 {linear_unknown("quadratic", -8.0 * scale, 8.0 * scale, scale)},
                                 {{0.2 * scale}}));
    }
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, quadratic_stiffness_effect, QuadraticStiffness)

}  // namespace bodesmith::gap
