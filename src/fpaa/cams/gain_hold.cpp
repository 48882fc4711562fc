#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& gain_hold_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "GainHold";
    t.options = {"Inverting", "Non-inverting"};
    t.parameters = {"gain"};
    t.transfer = "-+gain, output held; its capacitor count is not publicly known";
    t.transfer_ground = Ground::seen;
    t.limits = "not placed by the program: resources unknown";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
