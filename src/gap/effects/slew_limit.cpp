#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

class SlewLimit final : public Effect {
 public:
  std::string_view name() const override { return "slew_limit"; }
  std::string_view what() const override { return "the rate of change is limited"; }
  std::string_view tell_tale() const override { return "a residual only where the slope is large"; }
  std::vector<std::string_view> confused_with() const override {
    return {"amplifier_pole", "saturation", "opamp_bandwidth"};
  }
  std::string_view experiment() const override {
    return "the same step at two amplitudes: the ramp's slope stays";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : scene.static_places()) {
      const auto& signal = scene.boundary[at];
      const double most = signal.slope_quantile(1.0);
      if (!(most > 0.0)) continue;
      std::vector<std::vector<double>> starts;
      for (double rate : {0.9 * most, 0.6 * most, 0.3 * most, 0.1 * most, signal.slope_quantile(0.95),
                          signal.slope_quantile(0.8)}) {
        starts.push_back({std::max(rate, 1e-3 * most)});
      }
      out.push_back(insert_block(scene, *this, at, chain::make_block("slew_limit"),
                                 {logarithmic_unknown("rate_per_s", 1e-4 * most, 2.0 * most)}, starts));
    }
  }
};

}  // namespace

const Effect& slew_limit_effect() {
  static const SlewLimit effect;
  return effect;
}

}  // namespace bodesmith::gap
