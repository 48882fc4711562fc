#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

class SampleHold final : public Effect {
 public:
  std::string_view name() const override { return "sample_hold"; }
  std::string_view what() const override { return "a clocked hold: droop and half a cycle of delay"; }
  std::string_view tell_tale() const override {
    return "a staircase: a residual that repeats with the clock";
  }
  std::vector<std::string_view> confused_with() const override { return {"time_delay", "amplifier_pole"}; }
  std::string_view experiment() const override {
    return "a faster clock, or a record sampled much faster than it";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    // Held signals lag by half a clock, so a delay is looked at first; the staircase then needs the clock to
    // within a fraction of a cycle over the record, hence whole ratios to the sampling rate and round
    // figures.
    std::vector<std::vector<double>> starts;
    const double rate = 1.0 / scene.step_s;
    for (double ratio : {2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 12.5, 15.0, 16.0, 20.0, 25.0, 30.0,
                         32.0, 40.0, 50.0}) {
      if (rate / ratio < scene.band_hz) continue;
      starts.push_back({rate / ratio});
    }
    if (starts.empty()) return;
    for (std::size_t at : scene.static_places()) {
      for (bool half : {false, true}) {
        auto block = chain::make_block("sample_hold");
        block.set("clock_hz", starts[0][0]).set("half_cycle", half ? 1.0 : 0.0);
        out.push_back(insert_block(scene, *this, at, block,
                                   {logarithmic_unknown("clock_hz", 0.5 * scene.band_hz, 2.0 * rate)},
                                   starts));
      }
    }
  }
};

}  // namespace

const Effect& sample_hold_effect() {
  static const SampleHold effect;
  return effect;
}

}  // namespace bodesmith::gap
