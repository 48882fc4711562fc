#pragma once

#include "fpaa/cams/cam_values.hpp"

namespace bodesmith::fpaa {

class Cam;

/// What the dialog of CAM Comparator asks for: hysteresis 0 or 0.01 V. Option "Signal Ground" compares with
/// 0.
struct ComparatorSpec {
  double hysteresis_v = 0.0;

  static constexpr const char* kSignalGround = "Signal Ground";
  CamValues values() const { return {{"hysteresis_v", hysteresis_v}}; }
};

const Cam& comparator_cam();

}  // namespace bodesmith::fpaa
