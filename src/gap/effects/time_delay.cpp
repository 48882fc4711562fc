#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class TimeDelay final : public Effect {
 public:
  TimeDelay()
      : Effect({.name = "time_delay",
                .what = "the signal arrives later",
                .experiment = "a sweep to higher frequencies: a pole loses gain, a delay does not",
                .linear = true,
                .of_no_circuit = true}) {}
  bool is_no_name(const Model&, const Term& term, const Scene& scene) const override {
    return scene.is_between_samples(term.unknowns.front().value);
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    const double step = scene.frequency_only ? 0.02 / scene.top_hz : scene.step_s;
    const double max_delay = scene.frequency_only ? 2.0 / scene.low_hz : 0.1 * scene.duration_s;
    Starts starts = {{0.3 * step}, {2.0 * step}, {0.05 / scene.band_hz}, {0.15 / scene.band_hz}};
    // Between those: of what the edges of steps show.
    for (double hz : scene.beyond_band_hz(1.0, 3)) {
      const double delay = 0.05 / hz;
      if (delay > 4.0 * step && delay < 0.025 / scene.band_hz && starts.size() < 6) starts.push_back({delay});
    }
    for (std::size_t at : scene.linear_places()) {
      out.push_back(insert_block(scene, *this, at, chain::make_block("delay"),
                                 {logarithmic_unknown("delay_s", 1e-3 * step, max_delay)}, starts));
    }
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, time_delay_effect, TimeDelay)

}  // namespace bodesmith::gap
