#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_gain_error(const Scene& scene, std::vector<Proposal>& out) {
  // A gain that may be fitted is no error.
  if (is_refitted(*scene.model, "gain")) return;
  for (std::size_t at : scene.linear_places()) {
    out.push_back(insert_block(scene, at, chain::make_block("gain").set("gain", 1.0),
                               {linear_unknown("gain", 0.2, 5.0, 0.1)}));
  }
}

}  // namespace

BODESMITH_EFFECT(gain_error, .what = "a static gain differs",
                 .experiment = "a static gain test at several input levels", .linear = true,
                 .propose = propose_gain_error)

}  // namespace bodesmith::gap
