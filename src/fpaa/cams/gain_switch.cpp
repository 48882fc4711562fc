#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// Gain of the input that the comparator selects, a clock late (seen). Its capacitors are not publicly counted.
class GainSwitchCam : public Cam {
 public:
  GainSwitchCam() : Cam(CamFacts{.name = "GainSwitch", .delay_cycles = 1.0}) {}

  /// Inputs: first signal, second signal, control (high: the first).
  CamStep step(const PlacedCam& cam) const override {
    return [first = cam.requested.number("gain_1").value_or(1.0),
            second = cam.requested.number("gain_2").value_or(1.0)](std::span<const double> inputs) {
      return inputs[2] > 0.5 ? first * inputs[0] : second * inputs[1];
    };
  }
  std::string picture_text(const PlacedCam&) const override { return "one of two, by a comparator"; }
};

}  // namespace

BODESMITH_ENTRY(Cam, gain_switch_cam, GainSwitchCam)

}  // namespace bodesmith::fpaa
