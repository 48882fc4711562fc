#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class TimeDelay final : public Effect {
 public:
  std::string_view name() const override { return "time_delay"; }
  std::string_view what() const override { return "the signal arrives later"; }
  std::string_view symptom() const override {
    return "a residual in proportion to the slope, phase growing with frequency";
  }
  std::vector<std::string_view> confused_with() const override {
    return {"amplifier_pole", "sample_hold", "rate_dependence"};
  }
  std::string_view experiment() const override {
    return "a sweep to higher frequencies: a pole loses gain, a delay does not";
  }
  bool linear() const override { return true; }
  bool is_no_name(const Model& model, const Scene& scene) const override {
    return scene.is_between_samples(model.terms().back().unknowns.front().value);
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    const double step = scene.frequency_only ? 0.02 / scene.top_hz : scene.step_s;
    const double max_delay = scene.frequency_only ? 2.0 / scene.low_hz : 0.1 * scene.duration_s;
    for (std::size_t at : scene.linear_places()) {
      out.push_back(
          insert_block(scene, *this, at, chain::make_block("delay"),
                       {logarithmic_unknown("delay_s", 1e-3 * step, max_delay)},
                       {{0.3 * step}, {2.0 * step}, {0.05 / scene.band_hz}, {0.15 / scene.band_hz}}));
    }
  }
};

}  // namespace

const Effect& time_delay_effect() {
  static const TimeDelay effect;
  return effect;
}

}  // namespace bodesmith::gap
