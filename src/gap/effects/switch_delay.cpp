#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class SwitchDelay final : public Effect {
 public:
  std::string_view name() const override { return "switch_delay"; }
  std::string_view what() const override { return "the branch switch acts late"; }
  std::string_view symptom() const override { return "a residual only just after the input turns"; }
  std::vector<std::string_view> confused_with() const override { return {"time_delay", "backlash"}; }
  std::string_view experiment() const override {
    return "a fast and a slow triangle: the wrong stretch after a turn lasts the same time in both";
  }
  bool is_no_name(const Model&, const Term& term, const Scene& scene) const override {
    return scene.is_between_samples(term.unknowns.front().value);
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : places_of_unused(scene, "switch_delay_s")) {
      const double step = scene.step_s;
      // Every turn moves with the delay, so the sum of squares is hilly: a comb over what is possible.
      Starts starts;
      for (double delay = 1.2 * step; delay < 0.4 / scene.low_hz && starts.size() < 30; delay *= 1.3)
        starts.push_back({delay});
      if (starts.empty()) starts.push_back({0.5 * step});
      auto delay = logarithmic_unknown("switch_delay_s", 0.01 * step, 0.5 / scene.low_hz);
      delay.hop = 0.1 * step;
      out.push_back(change_block(scene, *this, at, {delay}, starts));
    }
  }
};

}  // namespace

const Effect& switch_delay_effect() {
  static const SwitchDelay effect;
  return effect;
}

}  // namespace bodesmith::gap
