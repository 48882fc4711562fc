#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& gain_voltage_controlled_cam() {
  static const Cam cam(CamFacts{
      .name = "GainVoltageControlled",
      .parameters = {{"max_gain"}},
      .clock_b_ratio = 16,
      .limits =
          "parameters only: its numbers are not publicly known; the program uses a Multiplier where it needs one"});
  return cam;
}

}  // namespace bodesmith::fpaa
