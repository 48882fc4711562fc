#include <algorithm>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

void propose_saturation(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    const auto& signal = scene.boundary[at];
    const double span = signal.span();
    if (!(span > 0.0)) continue;
    const double far = 1e3 * std::max(signal.size(), span);
    const double middle = quantile(signal.values, 0.5);
    Starts above;
    Starts below;
    Starts both;
    for (double part : {0.95, 0.85, 0.7}) {
      const double high = middle + part * (signal.high - middle);
      const double low = middle + part * (signal.low - middle);
      above.push_back({high});
      below.push_back({low});
      both.push_back({low, high});
    }
    const auto upper =
        linear_unknown("upper", signal.low + 0.02 * span, signal.high + 0.1 * span, 0.1 * span);
    const auto lower =
        linear_unknown("lower", signal.low - 0.1 * span, signal.high - 0.02 * span, 0.1 * span);
    auto block = chain::make_block("saturation");
    block.set("lower", -far).set("upper", far);
    out.push_back(insert_block(scene, at, block, {upper}, above));
    out.push_back(insert_block(scene, at, block, {lower}, below));
    out.push_back(insert_block(scene, at, block, {lower, upper}, both));
  }
}

}  // namespace

BODESMITH_EFFECT(saturation, .what = "the amplitude is limited",
                 .experiment = "a slow ramp to the ends of the range: a limit is flat",
                 .propose = propose_saturation)

}  // namespace bodesmith::gap
