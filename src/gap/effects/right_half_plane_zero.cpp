#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_right_half_plane_zero(const Scene& scene, std::vector<Proposal>& out) {
  if (!scene.frequency_only) return;
  const double low = 0.3 * scene.low_hz;
  const double high = 100.0 * scene.top_hz;
  Starts corners;
  Starts both;
  for (double hz = scene.low_hz; hz < 10.0 * scene.top_hz; hz *= 3.0) {
    corners.push_back({hz});
    for (double ratio : {0.3, 1.0, 3.0, 10.0}) both.push_back({hz, ratio * hz});
  }
  for (std::size_t at : scene.linear_places()) {
    // The all-pass; and a zero and a pole, which does nothing far above what was measured.
    out.push_back(insert_block(scene, at, chain::make_block("right_half_plane_zero"),
                               {logarithmic_unknown("corner_hz", low, high)}, corners,
                               [](chain::Block& b, std::span<const double> v) {
                                 b.set("right_zero_hz", v[0]).set("pole_hz", v[0]);
                               }));
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
