#include <cmath>
#include <string>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// y = u + c u^power. With s the size of the signal there, c is bounded by 2/s^(power-1).
auto smooth_curve(int power) {
  return [power](const Scene& scene, std::vector<Proposal>& out) {
    std::vector<double> coefficients(static_cast<std::size_t>(power) + 1, 0.0);
    coefficients[1] = 1.0;
    auto block = chain::make_block("polynomial");
    block.set("coefficients", coefficients);
    for (std::size_t at : scene.static_places()) {
      const double scale = 0.1 / std::pow(scene.boundary[at].size(), power - 1);
      const std::string name = "coefficients[" + std::to_string(power) + "]";
      out.push_back(
          insert_block(scene, at, block, {linear_unknown(name, -20.0 * scale, 20.0 * scale, scale)}));
    }
  };
}

constexpr const char* kExperiment = "the same drive at two amplitudes with and without a bias";

}  // namespace

BODESMITH_EFFECT(quadratic_nonlinearity, .what = "a smooth even static curve", .experiment = kExperiment,
                 .propose = smooth_curve(2))

BODESMITH_EFFECT(cubic_nonlinearity, .what = "a smooth odd static curve", .experiment = kExperiment,
                 .propose = smooth_curve(3))

}  // namespace bodesmith::gap
