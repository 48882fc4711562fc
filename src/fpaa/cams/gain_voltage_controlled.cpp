#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

/// Its numbers are not publicly known: the program uses a Multiplier where it needs one.
const Cam& gain_voltage_controlled_cam() {
  static const Cam cam(CamFacts{.name = "GainVoltageControlled", .clock_b_ratio = 16});
  return cam;
}

}  // namespace bodesmith::fpaa
