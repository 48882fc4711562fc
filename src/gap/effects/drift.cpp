#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

void propose_drift(const Scene& scene, std::vector<Proposal>& out) {
  const double rate = scene.boundary.back().size() / scene.duration_s;
  out.push_back(insert_block(scene, scene.end(), chain::make_block("drift"),
                             {linear_unknown("rate_per_s", -10.0 * rate, 10.0 * rate, 0.1 * rate)}));
}

}  // namespace

BODESMITH_EFFECT(drift, .what = "the output moves slowly and linearly with time",
                 .experiment = "a record at rest, without drive: drift goes on", .propose = propose_drift)

}  // namespace bodesmith::gap
