#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/effects/plays.hpp"
#include "gap/records/one_loop.hpp"

namespace bodesmith::gap {
namespace {

/// A sharpness other than 1 of a Bouc-Wen loop has no closed form and takes ten times as long: for records up
/// to this many samples only.
constexpr std::size_t kMaxSamplesWithSharpness = 5000;

/// A bank of plays (Prandtl-Ishlinskii), dense enough for any smooth loop.
Proposal plays(const Scene& scene, std::size_t at, double half) {
  const auto bank = play_bank(half);
  auto block = chain::make_block("prandtl_ishlinskii");
  block.set("r", bank.radius).set("w", bank.weight);
  return insert_block(scene, at, block, bank.unknowns, {bank.start});
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
Proposal bouc_wen(const Scene& scene, std::size_t at, double half, bool sharpness) {
  auto block = chain::make_block("bouc_wen").set("k", 1.0).set("A", 0.1).set("beta", 1.0).set("gamma", 0.0);
  std::vector<Unknown> unknowns = {
      linear_unknown("A", -3.0, 0.9, 0.1), logarithmic_unknown("beta", 0.02, 20.0),
      linear_unknown("gamma_over_beta", -0.9, 1.0, 0.2), linear_unknown("n", 1.0, 2.0, 0.3)};
  if (!sharpness) unknowns.pop_back();
  Starts starts;
  for (double a : {0.1, -0.1}) {
    for (double beta : {1.0, 5.0}) {
      starts.push_back({a, beta, 0.0});
      if (sharpness) starts.back().push_back(1.1);
    }
  }
  return insert_block(scene, at, block, unknowns, starts, [half](chain::Block& b, std::span<const double> v) {
    const double n = v.size() > 3 ? v[3] : 1.0;
    const double beta = v[1] / std::pow(half, n);
    b.set("A", v[0]).set("beta", beta).set("gamma", v[2] * beta).set("n", n);
  });
}

void propose_hysteresis(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.static_places()) {
    const double half = 0.5 * scene.boundary[at].span();
    if (!(half > 0.0)) continue;
    out.push_back(plays(scene, at, half));
    if (!is_one_loop(scene, at)) out.push_back(two_plays(scene, at, half));
    out.push_back(bouc_wen(scene, at, half, false));
    if (scene.residual.size() <= kMaxSamplesWithSharpness) out.push_back(bouc_wen(scene, at, half, true));
  }
}

}  // namespace

BODESMITH_EFFECT(
    hysteresis, .what = "rate-independent memory",
    .experiment =
        "loops of several amplitudes at two frequencies: memory keeps its loop when the frequency changes",
    .propose = propose_hysteresis)

}  // namespace bodesmith::gap
