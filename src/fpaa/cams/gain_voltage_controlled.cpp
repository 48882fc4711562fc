#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& gain_voltage_controlled_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "GainVoltageControlled";
    t.parameters = {"gain_most"};
    t.transfer = "";
    t.transfer_ground = Ground::unknown;
    t.clock_b_ratio = 16;
    t.limits =
        "parameters only: its numbers are not publicly known; the program uses a Multiplier where it needs "
        "one";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
