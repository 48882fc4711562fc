#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Where a coefficient that is 0 in a base resonator may lie.
struct Range {
  Unknown unknown;
  Starts starts;
};
using RangeOf = Range (*)(std::string key, const chain::Block& resonator, const Signal& deflection);

auto at_unused(const char* key, RangeOf range_of) {
  return [key, range_of](const Scene& scene, std::vector<Proposal>& out) {
    for (std::size_t at : places_of_unused(scene, key)) {
      auto range = range_of(key, scene.model->at(at), scene.boundary[at + 1]);
      out.push_back(change_block(scene, at, {std::move(range.unknown)}, std::move(range.starts)));
    }
  };
}

/// Of a spring's coefficient that is a tenth of the linear one at the greatest deflection when it is `typical`.
Range spring_range(std::string key, double typical) {
  return {linear_unknown(std::move(key), -8.0 * typical, 8.0 * typical, typical), {{0.2 * typical}}};
}

/// From a thousandth of the linear damping, of the greatest deflection at the natural frequency, to ten times what holds up
/// the spring at the speeds there are (slow drives) or the mass (fast ones): a free damping ratio may have taken all of it over.
Range drag_range(std::string key, const chain::Block& resonator, const Signal& deflection) {
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

Range cubic_range(std::string key, const chain::Block&, const Signal& deflection) {
  return spring_range(std::move(key), 0.1 / (deflection.size() * deflection.size()));
}

Range quadratic_range(std::string key, const chain::Block&, const Signal& deflection) {
  return spring_range(std::move(key), 0.1 / deflection.size());
}

}  // namespace

BODESMITH_EFFECT(
    cubic_stiffness, .what = "a cubic term in a resonator's spring",
    .experiment = "sweeps at two amplitudes: a spring moves the resonance, a static curve does not",
    .propose = at_unused("cubic", cubic_range))

BODESMITH_EFFECT(
    quadratic_stiffness, .what = "a quadratic term in a resonator's spring",
    .experiment =
        "the same drive with two biases: a quadratic spring moves the resonance with the bias, an offset does not",
    .propose = at_unused("quadratic", quadratic_range))

BODESMITH_EFFECT(drag, .what = "damping in proportion to |v| v inside a resonator",
                 .experiment = "ring-downs from two amplitudes: drag damps the larger one more",
                 .propose = at_unused("drag", drag_range))

}  // namespace bodesmith::gap
