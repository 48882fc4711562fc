#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A coefficient that is 0 in a base resonator.
class ResonatorTerm final : public Effect {
 public:
  struct Range {
    Unknown unknown;
    Starts starts;
  };
  using RangeOf = Range (*)(std::string key, const chain::Block& resonator, const Signal& deflection);
  ResonatorTerm(EffectFacts facts, const char* key, RangeOf range_of)
      : Effect(std::move(facts)), key_(key), range_of_(range_of) {}
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    for (std::size_t at : places_of_unused(scene, key_)) {
      auto range = range_of_(key_, scene.model->at(at), scene.boundary[at + 1]);
      out.push_back(change_block(scene, *this, at, {std::move(range.unknown)}, std::move(range.starts)));
    }
  }

 private:
  const char* key_;
  RangeOf range_of_;
};

/// Of a spring's coefficient that is a tenth of the linear one at the greatest deflection when it is `typical`.
ResonatorTerm::Range spring_range(std::string key, double typical) {
  return {linear_unknown(std::move(key), -8.0 * typical, 8.0 * typical, typical), {{0.2 * typical}}};
}

/// From a thousandth of the linear damping, of the greatest deflection at the natural frequency, to ten times what holds up
/// the spring at the speeds there are (slow drives) or the mass (fast ones): a free damping ratio may have taken all of it over.
ResonatorTerm::Range drag_range(std::string key, const chain::Block& resonator, const Signal& deflection) {
  const double w = Hertz{resonator.get("natural_frequency_hz")}.rad_s().value;
  const double speed = std::max(deflection.slope_quantile(0.5), 1e-3 * deflection.slope_quantile(1.0));
  const double w_size = w * deflection.size();
  const double low = 2e-3 * resonator.get("damping_ratio") / w_size;
  const double high = 10.0 * std::max(1.0 / w_size, speed > 0.0 ? w_size / (speed * speed) : 0.0);
  Starts starts;
  for (double start = 20.0 * low; start < high; start *= 10.0) starts.push_back({start});
  if (starts.empty()) starts.push_back({std::sqrt(low * high)});
  return {logarithmic_unknown(std::move(key), low, high), std::move(starts)};
}

}  // namespace

const Effect& cubic_stiffness_effect() {
  static const ResonatorTerm effect(
      {.name = "cubic_stiffness",
       .what = "a cubic term in a resonator's spring",
       .experiment = "sweeps at two amplitudes: a spring moves the resonance, a static curve does not"},
      "cubic", [](std::string key, const chain::Block&, const Signal& deflection) {
        return spring_range(std::move(key), 0.1 / (deflection.size() * deflection.size()));
      });
  return effect;
}

const Effect& quadratic_stiffness_effect() {
  static const ResonatorTerm effect(
      {.name = "quadratic_stiffness",
       .what = "a quadratic term in a resonator's spring",
       .experiment =
           "the same drive with two biases: a quadratic spring moves the resonance with the bias, an offset does not"},
      "quadratic", [](std::string key, const chain::Block&, const Signal& deflection) {
        return spring_range(std::move(key), 0.1 / deflection.size());
      });
  return effect;
}

const Effect& drag_effect() {
  static const ResonatorTerm effect(
      {.name = "drag",
       .what = "damping in proportion to |v| v inside a resonator",
       .experiment = "ring-downs from two amplitudes: drag damps the larger one more"},
      "drag", drag_range);
  return effect;
}

}  // namespace bodesmith::gap
