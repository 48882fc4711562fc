#include <algorithm>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class AmplifierPole final : public Effect {
 public:
  AmplifierPole()
      : Effect(
            {.name = "amplifier_pole",
             .what = "a first-order lag",
             .experiment =
                 "a sweep to higher frequencies, and the same step at two amplitudes (a slew limit scales with it, "
                 "a pole does not)",
             .linear = true,
             .repeatable_in_response = true}) {}
  bool is_no_name(const Model&, const Term& term, const Scene& scene) const override {
    return scene.is_between_samples(1.0 / Hertz{term.unknowns.front().value}.rad_s().value);
  }
  /// A circuit whose op-amps are known has no lag but theirs.
  bool is_implausible(const Model& model, const Scene& /*scene*/) const override {
    for (std::size_t at = 0; at < model.size(); ++at) {
      const auto& parts = model.at(at).parts;
      if (parts &&
          std::any_of(parts->begin(), parts->end(), [](const auto& p) { return !p.noise_gain.empty(); }))
        return true;
    }
    return false;
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
