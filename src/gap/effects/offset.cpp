#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class Offset final : public Effect {
 public:
  std::string_view name() const override { return "offset"; }
  std::string_view what() const override { return "a constant is added"; }
  std::vector<std::string_view> confused_with() const override {
    return {"quadratic_nonlinearity", "quadratic_stiffness", "drift"};
  }
  std::string_view experiment() const override {
    return "the same drive at two amplitudes: an offset stays, a curvature grows with the square";
  }
  int places_a_round() const override { return 3; }
  bool adds_one_signal() const override { return true; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : places(scene)) {
      const double size = scene.boundary[at].size();
      out.push_back(insert_block(scene, *this, at, chain::make_block("gain").set("gain", 1.0),
                                 {linear_unknown("offset", -10.0 * size, 10.0 * size, 0.1 * size)},
                                 {{0.01 * size}}));
    }
  }

 private:
  /// Through a linear stretch a constant is the same wherever it enters, once what it sets going at the first sample is
  /// over; of a record from rest each dynamic block behind it shows another start.
  static std::vector<std::size_t> places(const Scene& scene) {
    return scene.model->chain().start == chain::Start::equilibrium ? scene.linear_places()
                                                                   : scene.static_places();
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, offset_effect, Offset)

}  // namespace bodesmith::gap
