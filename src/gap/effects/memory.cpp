#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/search_options.hpp"

namespace bodesmith::gap {
namespace {

/// A bank of plays with fixed radii in parallel with the straight line u, as a prandtl_ishlinskii block: linear in its
/// weights, which are the unknowns. Dense enough for any smooth loop. Symmetric and asymmetric memory have the same
/// one: which of them is named must not hang on whose radii happen to lie nearer to the truth.
struct PlayBank {
  chain::Block block = chain::make_block("prandtl_ishlinskii");
  std::vector<Unknown> unknowns;
};

PlayBank play_bank(double half_range) {
  constexpr std::array kParts = {0.02, 0.06, 0.12, 0.2, 0.3, 0.42, 0.56, 0.72, 0.88};
  PlayBank bank;
  std::vector<double> radius = {0.0};
  std::vector<double> weight = {1.0};
  for (std::size_t k = 0; k < kParts.size(); ++k) {
    radius.push_back(kParts[k] * half_range);
    weight.push_back(0.005);
    bank.unknowns.push_back(linear_unknown("w[" + std::to_string(k + 1) + "]", 0.0, 5.0, 0.05));
  }
  bank.block.set("r", radius).set("w", weight);
  return bank;
}

/// Two plays of free radii: of few plays a bank's fixed radii miss the corners.
Proposal two_plays(const Scene& scene, std::size_t at, double half) {
  auto block = chain::make_block("prandtl_ishlinskii");
  block.set("r", std::vector{0.0, 0.1 * half, 0.3 * half}).set("w", std::vector{1.0, 0.1, 0.1});
  std::vector<Unknown> unknowns;
  for (const char* k : {"[1]", "[2]"}) {
    unknowns.push_back(logarithmic_unknown("r" + std::string(k), 0.01 * half, half));
    unknowns.push_back(linear_unknown("w" + std::string(k), 0.0, 5.0, 0.05));
  }
  Starts starts;
  for (const auto& [narrow, wide] : {std::pair(0.02, 0.06), std::pair(0.06, 0.2), std::pair(0.2, 0.6)})
    starts.push_back({narrow * half, 0.1, wide * half, 0.1});
  return insert_block(scene, at, block, unknowns, starts, [](chain::Block& b, std::span<const double> v) {
    // Their order may be lost on the way of a fit.
    const std::size_t narrow = v[0] < v[2] ? 0 : 2;
    const std::size_t wide = 2 - narrow;
    b.set("r", std::vector{0.0, v[narrow], std::max(v[wide], 1.001 * v[narrow])})
        .set("w", std::vector{1.0, v[narrow + 1], v[wide + 1]});
  });
}

/// y = u - z with gamma as a share of beta, and beta for a signal of half range 1 (whatever its unit): a
/// smooth loop that the plays only follow in corners.
Proposal bouc_wen(const Scene& scene, std::size_t at, double half) {
  auto block = chain::make_block("bouc_wen").set("k", 1.0).set("A", 0.1).set("beta", 1.0).set("gamma", 0.0);
  const std::vector<Unknown> unknowns = {linear_unknown("A", -3.0, 0.9, 0.1),
                                         logarithmic_unknown("beta", 0.02, 20.0),
                                         linear_unknown("gamma_over_beta", -0.9, 1.0, 0.2)};
  Starts starts;
  for (double a : {0.1, -0.1}) {
    for (double gamma : {0.3, -0.3}) starts.push_back({a, 2.0, gamma});
  }
  return insert_block(scene, at, block, unknowns, starts, [half](chain::Block& b, std::span<const double> v) {
    const double beta = v[1] / half;
    b.set("A", v[0]).set("beta", beta).set("gamma", v[2] * beta);
  });
}

void propose_hysteresis(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    const double half = 0.5 * scene.boundary[at].span();
    if (!(half > 0.0)) continue;
    const auto bank = play_bank(half);
    out.push_back(insert_block(scene, at, bank.block, bank.unknowns));
    out.push_back(two_plays(scene, at, half));
    out.push_back(bouc_wen(scene, at, half));
  }
}

/// Loops that are less wide than this part of the curve next to them are none: as little as what a name must explain.
const double kMinLoop = kExplained;

/// All there is to fit is one record in which this signal goes from end to end again and again: a play that follows it turns nowhere
/// else, but on the way in from the start.
bool is_one_loop(const Scene& scene, std::size_t at) {
  const Signal& signal = scene.boundary[at];
  const double reach = kMinLoop * signal.span();
  double play = signal.values.front();
  double last_step = 0.0;
  int turns = 0;
  for (const double v : signal.values) {
    const double step = std::clamp(play, v - 0.5 * reach, v + 0.5 * reach) - play;
    if (step == 0.0) continue;
    const double inside = step > 0.0 ? play - signal.low : signal.high - play;
    if (step * last_step < 0.0 && ++turns > 2 && inside > 1.5 * reach) return false;
    last_step = step;
    play += step;
  }
  return scene.records == 1;
}

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
  for (const double x : signal.values) {
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
  for (const bool descending : {false, true}) {
    for (int k = free_gain && descending ? 1 : 0; k < 3; ++k) {
      const double scale = 0.1 * std::pow(scene.boundary[at].size(), -k);
      unknowns.push_back(linear_unknown((descending ? "descending[" : "ascending[") + std::to_string(k) + "]",
                                        -20.0 * scale, 20.0 * scale, scale));
    }
  }
  return insert_block(scene, at, block, unknowns, {},
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
  const std::vector<double> weights(bank.unknowns.size(), 0.01);
  bank.unknowns.push_back(linear_unknown("s[0]", signal.low, signal.high, scale));
  bank.unknowns.push_back(linear_unknown("v[0]", -0.9, 5.0, 0.05));
  // A memory that is not at rest at zero stands somewhere.
  bank.unknowns.push_back(linear_unknown("offset", -span, span, scale));
  const bool free_gain = is_refitted(*scene.model, "gain");
  if (!free_gain) bank.unknowns.push_back(linear_unknown("w[0]", 0.2, 5.0, 0.05));
  Starts starts;
  for (const double part : {0.35, 0.5, 0.65}) {
    auto& start = starts.emplace_back(weights);
    start.insert(start.end(), {signal.low + part * span, 0.01, 0.0});
    if (!free_gain) start.push_back(1.0);
  }
  bank.block.set("s", std::vector{span}).set("v", std::vector{0.0});
  return insert_block(scene, at, bank.block, bank.unknowns, starts);
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

/// A Bouc-Wen loop of another rate each way. It rests at zero wherever its state does; how steep it is without the loop, a gain tells
/// where one is free.
Proposal rates_each_way(const Scene& scene, std::size_t at) {
  const double span = scene.boundary[at].span();
  auto block = chain::make_block("bouc_wen").set("k", 1.0).set("A", 0.1).set("beta", 1.0).set("gamma", 0.0);
  std::vector<Unknown> unknowns = {
      linear_unknown("A", -3.0, 3.0, 0.1), logarithmic_unknown("beta", 0.02, 20.0),
      linear_unknown("delta_over_beta", -0.95, 0.95, 0.2), linear_unknown("z_0_share", -1.0, 1.0, 0.2)};
  const bool free_gain = is_refitted(*scene.model, "gain");
  if (!free_gain) unknowns.push_back(linear_unknown("k", 0.2, 5.0, 0.05));
  Starts starts;
  for (const double a : {0.1, -0.1}) {
    for (const double skew : {0.3, -0.3}) {
      starts.push_back({a, 2.0, skew, 0.0});
      if (!free_gain) starts.back().push_back(1.0);
    }
  }
  return insert_block(scene, at, block, unknowns, starts, [span](chain::Block& b, std::span<const double> v) {
    const double beta = 2.0 * v[1] / span;
    b.set("A", v[0]).set("beta", beta).set("delta", v[2] * beta);
    // A share of what its state can come to: more would be a constant by another name.
    const double rest = v[3] * v[0] / (beta * (1.0 - std::abs(v[2])));
    b.set("z_0", rest).set("offset", rest);
    if (v.size() > 4) b.set("k", v[4]);
  });
}

void propose_asymmetric_hysteresis(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    // One loop alone says nothing of smaller ones: fitted asymmetry would be that loop's shape.
    if (!(scene.boundary[at].span() > 0.0) || is_one_loop(scene, at)) continue;
    out.push_back(branches(scene, at));
    out.push_back(plays_and_knee(scene, at));
    out.push_back(uneven_stop(scene, at));
    out.push_back(rates_each_way(scene, at));
  }
}

/// Branches that coincide are a curve, even halves and rates hysteresis.
bool asymmetric_hysteresis_is_no_name(const Model& model, const Term& term, const Scene& scene) {
  const std::size_t at = model.position_of(term.blocks.front());
  const auto& block = model.at(at);
  const auto& signal = scene.boundary[at];
  if (block.has("ascending")) return is_curve_of_branches(block, signal);
  if (block.has("delta")) return std::abs(block.get("delta")) < kMinLoop * block.get("beta");
  return block.list("e").empty() ? is_knee_or_plays_alone(block, signal) : is_even_stop(block);
}

}  // namespace

BODESMITH_EFFECT(
    hysteresis, .what = "rate-independent memory",
    .experiment =
        "loops of several amplitudes at two frequencies: memory keeps its loop when the frequency changes",
    .propose = propose_hysteresis)

BODESMITH_EFFECT(asymmetric_hysteresis, .what = "memory whose ascending and descending branches differ",
                 .experiment = "loops of several amplitudes about several biases",
                 .propose = propose_asymmetric_hysteresis, .is_no_name = asymmetric_hysteresis_is_no_name)

}  // namespace bodesmith::gap
