#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class GainError final : public Effect {
 public:
  GainError()
      : Effect({.name = "gain_error",
                .what = "a static gain differs",
                .experiment = "a static gain test at several input levels",
                .linear = true}) {}
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    // A gain that may be fitted is no error.
    if (is_refitted(*scene.model, "gain")) return;
    for (std::size_t at : scene.linear_places()) {
      out.push_back(insert_block(scene, *this, at, chain::make_block("gain").set("gain", 1.0),
                                 {linear_unknown("gain", 0.2, 5.0, 0.1)}, {{1.02}}));
    }
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, gain_error_effect, GainError)

}  // namespace bodesmith::gap
