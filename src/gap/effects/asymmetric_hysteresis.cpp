#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
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

/// Of plays and the knee behind them one does next to nothing: a curve, or symmetric memory.
bool is_knee_or_plays_alone(const chain::Block& block, const Signal& signal) {
  const auto& weight = block.list("w");
  const auto& radius = block.list("r");
  const double at = block.list("s")[0];
  double loop = 0.0;
  for (std::size_t k = 0; k < weight.size(); ++k) loop += weight[k] * radius[k];
  const double reach = std::max(0.0, at > 0.0 ? signal.high - at : at - signal.low);
  const double bend = std::abs(block.list("v")[0]) * reach;
  return loop < kMinLoop * bend || bend < kMinLoop * loop;
}

/// Halves of a stop that weigh the same are symmetric memory.
bool is_even_stop(const chain::Block& block) {
  const double below = block.list("w")[1];
  const double above = below - block.list("e")[1];
  return std::abs(above - below) < kMinLoop * (above + below);
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

/// Plays x followed by a knee (Kuhnen 2003): x + v max(0, x - s), of negative s x + v min(0, x - s). How steep the memory is without
/// either, a gain tells where one is free.
Proposal plays_and_knee(const Scene& scene, std::size_t at) {
  const auto& signal = scene.boundary[at];
  const double span = signal.span();
  const double scale = 0.025 * span;
  auto bank = play_bank(0.5 * span);
  const std::size_t plays = bank.unknowns.size();
  bank.unknowns.push_back(linear_unknown("s[0]", signal.low, signal.high, scale));
  bank.unknowns.push_back(linear_unknown("v[0]", -0.9, 5.0, 0.05));
  // A memory that is not at rest at zero stands somewhere.
  bank.unknowns.push_back(linear_unknown("offset", -span, span, scale));
  const bool free_gain = is_refitted(*scene.model, "gain");
  if (!free_gain) bank.unknowns.push_back(linear_unknown("w[0]", 0.2, 5.0, 0.05));
  Starts starts;
  for (const double part : {0.35, 0.5, 0.65}) {
    auto& start = starts.emplace_back(bank.start);
    start.insert(start.end(), {signal.low + part * span, 0.01, 0.0});
    if (!free_gain) start.push_back(1.0);
  }
  auto block = chain::make_block("prandtl_ishlinskii");
  block.set("r", bank.radius).set("w", bank.weight).set("s", std::vector{span}).set("v", std::vector{0.0});
  return insert_block(scene, at, block, bank.unknowns, starts,
                      [plays, free_gain](chain::Block& b, std::span<const double> v) {
                        std::vector<double> weight(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(plays));
                        weight.insert(weight.begin(), free_gain ? 1.0 : v[plays + 3]);
                        const double knee = v[plays] == 0.0 ? std::numeric_limits<double>::min() : v[plays];
                        b.set("w", weight).set("s", std::vector{knee}).set("v", std::vector{v[plays + 1]});
                        b.set("offset", v[plays + 2]);
                      });
}

/// A stop s = x - play(x) whose halves weigh differently: x - above max(0, s) - below min(0, s).
Proposal uneven_stop(const Scene& scene, std::size_t at) {
  const double half = 0.5 * scene.boundary[at].span();
  const std::vector<Unknown> unknowns = {logarithmic_unknown("r[1]", 0.01 * half, half),
                                         linear_unknown("above", 0.0, 0.95, 0.05),
                                         linear_unknown("below", 0.0, 0.95, 0.05)};
  Starts starts;
  for (const double part : {0.06, 0.2, 0.6}) starts.push_back({part * half, 0.1, 0.1});
  auto block = chain::make_block("prandtl_ishlinskii");
  block.set("r", std::vector{0.0, half}).set("w", std::vector{1.0, 0.0});
  return insert_block(scene, at, block, unknowns, starts, [](chain::Block& b, std::span<const double> v) {
    const double above = v[1];
    const double below = v[2];
    b.set("r", std::vector{0.0, v[0]}).set("w", std::vector{1.0 - below, below});
    b.set("e", std::vector{0.0, below - above});
  });
}

void propose_asymmetric_hysteresis(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    if (!(scene.boundary[at].span() > 0.0)) continue;
    // One loop alone says nothing of smaller ones: fitted asymmetry would be that loop's shape.
    if (is_one_loop(scene, at)) continue;
    out.push_back(branches(scene, at));
    out.push_back(plays_and_knee(scene, at));
    out.push_back(uneven_stop(scene, at));
  }
}

/// Branches that coincide are a curve, even halves hysteresis.
bool asymmetric_hysteresis_is_no_name(const Model& model, const Term& term, const Scene& scene) {
  const std::size_t at = model.position_of(term.blocks.front());
  const auto& block = model.at(at);
  const auto& signal = scene.boundary[at];
  if (block.has("ascending")) return is_curve_of_branches(block, signal);
  return block.list("e").empty() ? is_knee_or_plays_alone(block, signal) : is_even_stop(block);
}

}  // namespace

BODESMITH_EFFECT(asymmetric_hysteresis, .what = "memory whose ascending and descending branches differ",
                 .experiment = "loops of several amplitudes about several biases", .places_a_round = 5,
                 .propose = propose_asymmetric_hysteresis, .is_no_name = asymmetric_hysteresis_is_no_name)

}  // namespace bodesmith::gap
