#include "gap/effects/power_term.hpp"

#include <fmt/format.h>

#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/records/one_loop.hpp"

namespace bodesmith::gap {

void propose_power_term(const Scene& scene, const Effect& effect, int power, std::vector<Proposal>& out) {
  if (scene.frequency_only) return;
  std::vector<double> coefficients(static_cast<std::size_t>(power) + 1, 0.0);
  coefficients[1] = 1.0;
  for (std::size_t at : scene.static_places()) {
    if (memory_may_bend(scene, at)) continue;
    const double size = scene.boundary[at].size();
    const double scale = 0.1 / std::pow(size, power - 1);
    auto block = chain::make_block("polynomial");
    block.set("coefficients", coefficients);
    out.push_back(insert_block(
        scene, effect, at, block,
        {linear_unknown(fmt::format("coefficients[{}]", power), -20.0 * scale, 20.0 * scale, scale)},
        {{0.05 * scale}, {-0.05 * scale}}));
  }
}

}  // namespace bodesmith::gap
