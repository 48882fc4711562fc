#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/effects/plays.hpp"
#include "gap/records/one_loop.hpp"
#include "gap/search_options.hpp"

namespace bodesmith::gap {
namespace {

/// Loops that are less wide than this part of the curve next to them are none: as little as what a name must explain.
const double kMinLoop = BoundOptions().explained;

bool is_curve_of_branches(const chain::Block& block, const Signal& signal) {
  const auto& up = block.list("ascending");
  const auto& down = block.list("descending");
  // Without the mean slope of both, which is a gain.
  const double slope = 0.5 * (up[0] + down[0]);
  const auto value = [&](const std::vector<double>& a, double x) {
    return x * (a[0] - slope + x * (a[1] + x * a[2]));
  };
  double curve = 0.0;
  double loop = 0.0;
  constexpr int kPoints = 20;
  for (int i = 0; i <= kPoints; ++i) {
    const double x = signal.low + signal.span() * i / kPoints;
    curve += std::pow(0.5 * (value(up, x) + value(down, x)), 2);
    loop += std::pow(0.5 * (value(up, x) - value(down, x)), 2);
  }
  return loop < kMinLoop * kMinLoop * curve;
}

bool is_curve_of_plays(const chain::Block& block, const Signal& signal) {
  const auto& weight = block.list("w");
  const auto& radius = block.list("r");
  const auto& threshold = block.list("s");
  const auto& slope = block.list("v");
  double loop = 0.0;
  for (std::size_t k = 0; k < weight.size(); ++k) loop += weight[k] * radius[k];
  double curve = 0.0;
  for (std::size_t k = 0; k < slope.size(); ++k) {
    const double reach = threshold[k] > 0.0 ? signal.high - threshold[k] : threshold[k] - signal.low;
    curve += std::abs(slope[k]) * std::max(0.0, reach);
  }
  return loop < kMinLoop * curve;
}

/// Branch polynomials (disturbance paper, eq. 1). With a free gain in the chain their common slope would be
/// counted twice: the descending branch then has the ascending one's with the other sign.
Proposal branches(const Scene& scene, std::size_t at) {
  const bool free_gain = is_refitted(*scene.model, "gain");
  auto block = chain::make_block("polynomial_hysteresis");
  block.set("ascending", std::vector<double>(3, 0.0)).set("descending", std::vector<double>(3, 0.0));
  std::vector<Unknown> unknowns;
  std::vector<double> start;
  for (const bool descending : {false, true}) {
    double scale = 0.1;
    for (int k = 0; k < 3; ++k) {
      if (!(free_gain && k == 0 && descending)) {
        unknowns.push_back(
            linear_unknown((descending ? "descending[" : "ascending[") + std::to_string(k) + "]",
                           -20.0 * scale, 20.0 * scale, scale));
        start.push_back(0.01 * scale);
      }
      scale /= scene.boundary[at].size();
    }
  }
  return insert_block(scene, at, block, unknowns, {start},
                      [free_gain](chain::Block& b, std::span<const double> v) {
                        const std::vector<double> up(v.begin(), v.begin() + 3);
                        std::vector<double> down(v.begin() + 3, v.end());
                        if (free_gain) down.insert(down.begin(), -v[0]);
                        b.set("ascending", up).set("descending", down);
                      });
}

/// Plays followed by one-sided dead zones (Kuhnen 2003).
Proposal plays_and_dead_zones(const Scene& scene, std::size_t at) {
  const auto& signal = scene.boundary[at];
  const double half = 0.5 * signal.span();
  auto bank = play_bank(half);
  std::vector<double> threshold;
  std::vector<double> slope;
  for (double part : {0.1, 0.4, 0.7, 0.9}) {
    double s = signal.low + part * signal.span();
    if (std::abs(s) < 1e-3 * half) s = 1e-3 * half;
    threshold.push_back(s);
    bank.unknowns.push_back(linear_unknown("v[" + std::to_string(slope.size()) + "]", -0.9, 5.0, 0.05));
    slope.push_back(0.01);
    bank.start.push_back(0.01);
  }
  auto block = chain::make_block("prandtl_ishlinskii");
  block.set("r", bank.radius).set("w", bank.weight).set("s", threshold).set("v", slope);
  return insert_block(scene, at, block, bank.unknowns, {bank.start});
}

void propose_asymmetric_hysteresis(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    if (!(scene.boundary[at].span() > 0.0)) continue;
    // One loop alone says nothing of smaller ones: fitted asymmetry would be that loop's shape.
    if (is_one_loop(scene, at)) continue;
    out.push_back(branches(scene, at));
    out.push_back(plays_and_dead_zones(scene, at));
  }
}

/// Branches that coincide are a curve, and so are one-sided dead zones behind plays without weight.
bool asymmetric_hysteresis_is_no_name(const Model& model, const Term& term, const Scene& scene) {
  const std::size_t at = model.position_of(term.blocks.front());
  const auto& block = model.at(at);
  const auto& signal = scene.boundary[at];
  return block.has("ascending") ? is_curve_of_branches(block, signal) : is_curve_of_plays(block, signal);
}

}  // namespace

BODESMITH_EFFECT(asymmetric_hysteresis, .what = "memory whose ascending and descending branches differ",
                 .experiment = "loops of several amplitudes about several biases",
                 .propose = propose_asymmetric_hysteresis, .is_no_name = asymmetric_hysteresis_is_no_name)

}  // namespace bodesmith::gap
