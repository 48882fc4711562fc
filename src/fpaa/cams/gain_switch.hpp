#pragma once

#include "fpaa/cams/cam_values.hpp"

namespace bodesmith::fpaa {

class Cam;

/// What the dialog of CAM GainSwitch asks for. Option "Dual Input": the comparator's inputs select one of two
/// signals.
struct GainSwitchSpec {
  double gain_1 = 1.0;
  double gain_2 = 1.0;

  static constexpr const char* kDualInput = "Dual Input";
  CamValues values() const { return {{"gain_1", gain_1}, {"gain_2", gain_2}}; }
};

const Cam& gain_switch_cam();

}  // namespace bodesmith::fpaa
