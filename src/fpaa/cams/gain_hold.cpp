#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& gain_hold_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "GainHold";
    f.options = {"Inverting", "Non-inverting"};
    f.parameters = {{"gain"}};
    f.transfer = "-+gain, output held; its capacitor count is not publicly known";
    f.transfer_ground = Ground::seen;
    f.limits = "not placed by the program: resources unknown";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
