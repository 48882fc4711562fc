#include "fpaa/cams/gain_switch.hpp"

#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/cam_step.hpp"

namespace bodesmith::fpaa {
namespace {

CamFacts gain_switch_facts() {
  CamFacts f;
  f.name = "GainSwitch";
  f.options = {"Ground", GainSwitchSpec::kDualInput, "Variable Reference"};
  f.parameters = {{"gain_1"}, {"gain_2"}};
  f.transfer = "gain of the input that the comparator selects; analogue output lags the control by one clock";
  f.transfer_ground = Ground::seen;
  f.delay_cycles = 1.0;
  f.limits = "capacitor count not publicly known; taken as a CAB of its own when placed";
  return f;
}

/// Inputs: first signal, second signal, control (high: the first).
class GainSwitchStep final : public CamStep {
 public:
  explicit GainSwitchStep(const GainSwitchSpec& spec) : spec_(spec) {}
  double at_edge(std::span<const double> inputs) override {
    return inputs[2] > 0.5 ? spec_.gain_1 * inputs[0] : spec_.gain_2 * inputs[1];
  }

 private:
  GainSwitchSpec spec_;
};

class GainSwitchCam : public Cam {
 public:
  GainSwitchCam() : Cam(gain_switch_facts()) {}

  std::unique_ptr<CamStep> step(const PlacedCam& cam) const override {
    return std::make_unique<GainSwitchStep>(GainSwitchSpec{cam.requested.number("gain_1").value_or(1.0),
                                                           cam.requested.number("gain_2").value_or(1.0)});
  }
  std::string picture_text(const PlacedCam&) const override { return "one of two, by a comparator"; }
};

}  // namespace

BODESMITH_ENTRY(Cam, gain_switch_cam, GainSwitchCam)

}  // namespace bodesmith::fpaa
