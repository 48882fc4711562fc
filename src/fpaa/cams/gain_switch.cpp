#include "fpaa/cams/gain_switch.hpp"

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& gain_switch_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "GainSwitch";
    f.options = {"Ground", GainSwitchSpec::kDualInput, "Variable Reference"};
    f.parameters = {{"gain_1"}, {"gain_2"}};
    f.transfer =
        "gain of the input that the comparator selects; analogue output lags the control by one clock";
    f.transfer_ground = Ground::seen;
    f.delay_cycles = 1.0;
    f.limits = "capacitor count not publicly known; taken as a CAB of its own when placed";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
