#pragma once

#include "fpaa/cams/cam_values.hpp"

namespace bodesmith::fpaa {

/// CAM Multiplier: Vout = scale X Y, one ClockA cycle late; Y goes through an 8-bit converter (SAR) over +-3
/// V, which runs on ClockB = 16 ClockA. Four capacitors, one op-amp, one comparator; with sample and hold six
/// and two.
struct Multiplier {
  double scale_per_v = 1.0;  ///< 0.33 to 4

  /// In the dialog.
  static const char* option() { return "Sample and Hold Off"; }
  CamValues values() const { return {{"scale_per_v", scale_per_v}}; }

  /// What the converter makes of Y, as that of a look-up table (transfer_function.hpp): the middle of one of 256 steps.
  static double quantised(double y_v);
  double output(double x_v, double y_v) const { return scale_per_v * x_v * quantised(y_v); }
};

}  // namespace bodesmith::fpaa
