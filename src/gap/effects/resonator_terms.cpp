#include <algorithm>
#include <cmath>

#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// The coefficient `key` that is 0 in a base resonator, of a spring: a tenth of the linear one at the greatest deflection when it is
/// typical. `power`: of the deflection in it.
auto spring(const char* key, int power) {
  return [=](const Scene& scene, std::vector<Proposal>& out) {
    for (std::size_t at : places_of_unused(scene, key)) {
      const double typical = 0.1 / std::pow(scene.boundary[at + 1].size(), power);
      out.push_back(change_block(scene, at, {linear_unknown(key, -8.0 * typical, 8.0 * typical, typical)}));
    }
  };
}

/// From a thousandth of the linear damping, of the greatest deflection at the natural frequency, to ten times what holds up
/// the spring at the speeds there are (slow drives) or the mass (fast ones): a free damping ratio may have taken all of it over.
void propose_drag(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : places_of_unused(scene, "drag")) {
    const chain::Block& resonator = scene.model->at(at);
    const Signal& deflection = scene.boundary[at + 1];
    const double w = Hertz{resonator.get("natural_frequency_hz")}.rad_s().value;
    const double speed = std::max(deflection.slope_quantile(0.5), 1e-3 * deflection.slope_quantile(1.0));
    const double w_size = w * deflection.size();
    const double low = 2e-3 * resonator.get("damping_ratio") / w_size;
    const double high = 10.0 * std::max(1.0 / w_size, speed > 0.0 ? w_size / (speed * speed) : 0.0);
    Starts starts;
    for (double start = 20.0 * low; start < high; start *= 10.0) starts.push_back({start});
    if (starts.empty()) starts.push_back({std::sqrt(low * high)});
    out.push_back(change_block(scene, at, {logarithmic_unknown("drag", low, high)}, starts));
  }
}

}  // namespace

BODESMITH_EFFECT(
    cubic_stiffness, .what = "a cubic term in a resonator's spring",
    .experiment = "sweeps at two amplitudes: a spring moves the resonance, a static curve does not",
    .propose = spring("cubic", 2))

BODESMITH_EFFECT(
    quadratic_stiffness, .what = "a quadratic term in a resonator's spring",
    .experiment =
        "the same drive with two biases: a quadratic spring moves the resonance with the bias, an offset does not",
    .propose = spring("quadratic", 1))

BODESMITH_EFFECT(drag, .what = "damping in proportion to |v| v inside a resonator",
                 .experiment = "ring-downs from two amplitudes: drag damps the larger one more",
                 .propose = propose_drag)

}  // namespace bodesmith::gap
