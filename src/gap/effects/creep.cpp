#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/whole_number.hpp"
#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Relaxations of one decade of a logarithmic creep.
constexpr int kOfDecade = 3;

/// y = u + c sum over decades of relaxations, equally strong at every time constant between two: after a step
/// c log10(t) (J. F. Curie's law; K. Kuhnen, 2003).
Proposal logarithmic(const Scene& scene, std::size_t at, double fast, double slow) {
  const int count = kOfDecade * whole_number<int>(std::ceil(std::log10(slow / fast)), 1, 20);
  auto block = chain::make_block("creep");
  const std::vector<double> zeros(static_cast<std::size_t>(count), 0.0);
  block.set("gains", zeros).set("time_constants_s", std::vector<double>(zeros.size(), slow));
  Starts starts;
  for (const auto& [from, to] : {std::pair(0.2, 0.55), std::pair(0.5, 0.85), std::pair(0.15, 0.85)})
    starts.push_back({0.02, fast * std::pow(slow / fast, from), fast * std::pow(slow / fast, to)});
  return insert_block(
      scene, at, block,
      {linear_unknown("gain_per_decade", 0.0, 1.0, 0.05),
       logarithmic_unknown("fastest_s", 0.3 * fast, 0.5 * slow),
       logarithmic_unknown("slowest_s", 2.0 * fast, slow)},
      starts, [count](chain::Block& b, std::span<const double> v) {
        // The order may be lost on the way of a fit.
        const double ratio = std::max(v[2] / v[1], 1.01);
        std::vector<double> times;
        for (int k = 0; k < count; ++k) times.push_back(v[1] * std::pow(ratio, (k + 0.5) / count));
        const double gain = v[0] * std::log10(ratio) / count;
        b.set("time_constants_s", times).set("gains", std::vector<double>(times.size(), gain));
      });
}

void propose_creep(const Scene& scene, std::vector<Proposal>& out) {
  // Slower ones are an integral, faster ones change nothing in the record.
  const double slow = 2.0 * scene.duration_s;
  const double fast = 0.08 / (scene.frequency_only ? scene.top_hz : scene.band_hz);
  for (std::size_t at : scene.linear_places()) {
    out.push_back(logarithmic(scene, at, fast, slow));
    auto many = chain::make_block("creep");
    const std::size_t count = 8;
    std::vector<double> times;
    std::vector<Unknown> unknowns;
    for (std::size_t k = 0; k < count; ++k) {
      times.push_back(fast * std::pow(slow / fast, static_cast<double>(k) / (count - 1.0)));
      unknowns.push_back(linear_unknown("gains[" + std::to_string(k) + "]", 0.0, 1.0, 0.05));
    }
    many.set("gains", std::vector<double>(count, 0.01)).set("time_constants_s", times);
    out.push_back(insert_block(scene, at, many, unknowns));
  }
}

}  // namespace

BODESMITH_EFFECT(creep, .what = "slow relaxation, logarithmic or of several time constants",
                 .experiment = "a long record after one step", .linear = true, .propose = propose_creep)

}  // namespace bodesmith::gap
