#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class Drift final : public Effect {
 public:
  std::string_view name() const override { return "drift"; }
  std::string_view what() const override { return "the output moves slowly and linearly with time"; }
  std::vector<std::string_view> confused_with() const override { return {"creep", "offset"}; }
  std::string_view experiment() const override { return "a record at rest, without drive: drift goes on"; }
  bool independent_of_input() const override { return true; }
  bool adds_one_signal() const override { return true; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    const double rate = scene.boundary.back().size() / scene.duration_s;
    out.push_back(insert_block(scene, *this, scene.end(), chain::make_block("drift"),
                               {linear_unknown("rate_per_s", -10.0 * rate, 10.0 * rate, 0.1 * rate)},
                               {{0.01 * rate}}));
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, drift_effect, Drift)

}  // namespace bodesmith::gap
