#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& gain_voltage_controlled_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "GainVoltageControlled";
    f.parameters = {{"max_gain"}};
    f.transfer = "";
    f.transfer_ground = Ground::unknown;
    f.clock_b_ratio = 16;
    f.limits =
        "parameters only: its numbers are not publicly known; the program uses a Multiplier where it needs "
        "one";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
