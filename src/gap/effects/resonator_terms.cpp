#include <cmath>

#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A coefficient that is 0 in a base resonator.
class ResonatorTerm final : public Effect {
 public:
  /// `typical`: the coefficient at which the term is about a tenth of the linear one, of a deflection of that size.
  using Typical = double (*)(const chain::Block& resonator, double size);
  ResonatorTerm(EffectFacts facts, const char* key, double least, double most, Typical typical)
      : Effect(std::move(facts)), key_(key), least_(least), most_(most), typical_(typical) {}
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    for (std::size_t at : places_of_unused(scene, key_)) {
      const double scale = typical_(scene.model->at(at), scene.boundary[at + 1].size());
      out.push_back(change_block(
          scene, *this, at, {linear_unknown(key_, least_ * scale, most_ * scale, scale)}, {{0.2 * scale}}));
    }
  }

 private:
  const char* key_;
  double least_;
  double most_;
  Typical typical_;
};

}  // namespace

const Effect& cubic_stiffness_effect() {
  static const ResonatorTerm effect(
      {.name = "cubic_stiffness",
       .what = "a cubic term in a resonator's spring",
       .confused_with = {"cubic_nonlinearity", "saturation", "drag"},
       .experiment = "sweeps at two amplitudes: a spring moves the resonance, a static curve does not"},
      "cubic", -8.0, 8.0, [](const chain::Block&, double size) { return 0.1 / (size * size); });
  return effect;
}

const Effect& quadratic_stiffness_effect() {
  static const ResonatorTerm effect(
      {.name = "quadratic_stiffness",
       .what = "a quadratic term in a resonator's spring",
       .confused_with = {"offset", "quadratic_nonlinearity"},
       .experiment =
           "the same drive with two biases: a quadratic spring moves the resonance with the bias, an offset does not"},
      "quadratic", -8.0, 8.0, [](const chain::Block&, double size) { return 0.1 / size; });
  return effect;
}

const Effect& drag_effect() {
  // |y'| y' of a signal of size S at the natural frequency is about (w S)^2.
  static const ResonatorTerm effect(
      {.name = "drag",
       .what = "damping in proportion to |v| v inside a resonator",
       .confused_with = {"cubic_stiffness"},
       .experiment = "ring-downs from two amplitudes: drag damps the larger one more"},
      "drag", -5.0, 50.0, [](const chain::Block& resonator, double size) {
        const double w = Hertz{resonator.get("natural_frequency_hz")}.rad_s().value;
        return 0.2 * resonator.get("damping_ratio") / (w * size);
      });
  return effect;
}

}  // namespace bodesmith::gap
