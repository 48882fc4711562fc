#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& gain_switch_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "GainSwitch";
    t.options = {"Ground", "Dual Input", "Variable Reference"};
    t.parameters = {"gain"};
    t.transfer =
        "gain of the input that the comparator selects; analogue output lags the control by one clock";
    t.transfer_ground = Ground::seen;
    t.delay_cycles = 1.0;
    t.limits = "capacitor count not publicly known; taken as a CAB of its own when placed";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
