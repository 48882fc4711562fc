#include "gap/effects/power_term.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {

void propose_power_term(const Scene& scene, const Effect& effect, int power, std::vector<Proposal>& out) {
  if (scene.frequency_only) return;
  std::vector<double> coefficients(static_cast<std::size_t>(power) + 1, 0.0);
  coefficients[1] = 1.0;
  const auto& terms = scene.model->terms();
  const bool memory = std::any_of(terms.begin(), terms.end(),
                                  [](const Term& term) { return term.effect->name() == "hysteresis"; });
  const bool lag =
      std::any_of(terms.begin(), terms.end(), [](const Term& term) { return term.effect->linear(); });
  for (std::size_t at : scene.static_places()) {
    // What bends one loop alone, beside memory (or a lag that looks like it), may be memory's own form as well.
    if ((memory && scene.is_one_loop(at)) || (lag && scene.is_one_loop_of_one_speed(at))) continue;
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
