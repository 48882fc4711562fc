#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

class QuadraticNonlinearity final : public Effect {
 public:
  std::string_view name() const override { return "quadratic_nonlinearity"; }
  std::string_view what() const override { return "a smooth even static curve"; }
  std::string_view tell_tale() const override { return "even harmonics, a residual like y to the power 2"; }
  std::vector<std::string_view> confused_with() const override {
    return {"offset", "quadratic_stiffness", "saturation"};
  }
  std::string_view experiment() const override {
    return "the same drive at two amplitudes with and without a bias";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : scene.static_places()) {
      const double size = scene.boundary[at].size();
      const double scale = 0.1 / std::pow(size, 1);
      auto block = chain::make_block("polynomial");
      block.set("coefficients", std::vector<double>{0.0, 1.0, 0.0});
      out.push_back(insert_block(scene, *this, at, block,
                                 {linear_unknown("coefficients[2]", -20.0 * scale, 20.0 * scale, scale)},
                                 {{0.05 * scale}, {-0.05 * scale}}));
    }
  }
};

}  // namespace

const Effect& quadratic_nonlinearity_effect() {
  static const QuadraticNonlinearity effect;
  return effect;
}

}  // namespace bodesmith::gap
