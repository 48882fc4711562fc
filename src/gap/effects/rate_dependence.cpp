#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_rate_dependence(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.linear_places()) {
    const double low = std::max(scene.low_hz, 1e-3 * scene.band_hz);
    Starts starts;
    for (double corner : {low, std::sqrt(low * scene.band_hz)}) {
      for (double beta : {-0.05, 0.05}) starts.push_back({1.0 / Hertz{corner}.rad_s().value, 0.05, beta});
    }
    // Of an order nearer to one than to none it is a pole or a zero.
    auto block = chain::make_block("fractional_lead_lag");
    block.set("lambda_s", starts[0][0]).set("x", 0.05).set("beta", 0.0);
    const double t = 1.0 / Hertz{scene.band_hz}.rad_s().value;
    out.push_back(insert_block(scene, at, block,
                               {logarithmic_unknown("lambda_s", 0.1 * t, 1e4 * t),
                                logarithmic_unknown("x", 1e-4, 0.8), linear_unknown("beta", -0.5, 0.5, 0.1)},
                               starts));
  }
}

}  // namespace

BODESMITH_EFFECT(rate_dependence, .what = "the gain changes with frequency by a fractional order",
                 .experiment = "a sweep over more decades", .linear = true,
                 .propose = propose_rate_dependence)

}  // namespace bodesmith::gap
