#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class AmplifierPole final : public Effect {
 public:
  std::string_view name() const override { return "amplifier_pole"; }
  std::string_view what() const override { return "a first-order lag"; }
  std::vector<std::string_view> confused_with() const override {
    return {"time_delay", "opamp_bandwidth", "slew_limit", "rate_dependence"};
  }
  std::string_view experiment() const override {
    return "a sweep to higher frequencies, and the same step at two amplitudes (a slew limit scales with it, "
           "a pole does not)";
  }
  bool linear() const override { return true; }
  bool repeatable_in_response() const override { return true; }
  bool is_no_name(const Model&, const Term& term, const Scene& scene) const override {
    return scene.is_between_samples(1.0 / Hertz{term.unknowns.front().value}.rad_s().value);
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    const double b = scene.band_hz;
    Starts starts = {{30.0 * b}, {6.0 * b}, {1.5 * b}, {0.4 * b}};
    for (double hz : scene.beyond_band_hz(30.0, 2)) starts.push_back({hz});
    const auto corner = logarithmic_unknown("corner_hz", 1e-3 * b, 1e3 * std::max(b, 0.03 * scene.top_hz));
    for (std::size_t at : scene.linear_places())
      out.push_back(insert_block(scene, *this, at, chain::make_block("lowpass"), {corner}, starts));
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, amplifier_pole_effect, AmplifierPole)

}  // namespace bodesmith::gap
