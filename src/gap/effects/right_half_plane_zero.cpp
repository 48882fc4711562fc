#include <array>
#include <cmath>
#include <utility>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A pole so many times above the measured band does nothing in it: the zero stands alone.
constexpr double kPoleOutOfTheWay = 1e3;
constexpr int kZeros = 8;
constexpr std::array kPoleOverZero = {0.3, 1.0, 3.0, 10.0};

/// The all-pass, or a zero without a pole.
Proposal one_corner(const Scene& scene, std::size_t at, double low, double high, bool all_pass,
                    const Starts& starts) {
  const double far = kPoleOutOfTheWay * scene.top_hz;
  return insert_block(scene, at, chain::make_block("right_half_plane_zero"),
                      {logarithmic_unknown(all_pass ? "corner_hz" : "right_zero_hz", low, high)}, starts,
                      [all_pass, far](chain::Block& b, std::span<const double> v) {
                        b.set("right_zero_hz", v[0]).set("pole_hz", all_pass ? v[0] : far);
                      });
}

void propose_right_half_plane_zero(const Scene& scene, std::vector<Proposal>& out) {
  if (!scene.frequency_only) return;
  const double low = 0.3 * scene.low_hz;
  const double high = 100.0 * scene.top_hz;
  Starts corners;
  Starts both;
  for (int k = 0; k < kZeros; ++k) {
    const double hz = scene.low_hz * std::pow(10.0 * scene.top_hz / scene.low_hz, k / (kZeros - 1.0));
    corners.push_back({hz});
    for (double ratio : kPoleOverZero) both.push_back({hz, ratio * hz});
  }
  for (std::size_t at : scene.linear_places()) {
    out.push_back(one_corner(scene, at, low, high, true, corners));
    out.push_back(one_corner(scene, at, low, high, false, corners));
    out.push_back(insert_block(
        scene, at, chain::make_block("right_half_plane_zero"),
        {logarithmic_unknown("right_zero_hz", low, high), logarithmic_unknown("pole_hz", low, high)}, both));
  }
}

}  // namespace

BODESMITH_EFFECT(
    right_half_plane_zero, .what = "a zero in the right half-plane: a step begins the wrong way",
    .experiment = "a sweep to higher frequencies: the phase of a zero comes to an end, a delay's does not",
    .linear = true, .far_fetched = true, .propose = propose_right_half_plane_zero)

}  // namespace bodesmith::gap
