#pragma once

#include <complex>
#include <string>

#include "base/units.hpp"

namespace bodesmith::schematic {

/// An operational amplifier as far as this program needs one. Open loop
///   A(s) = A0 / (1 + s A0 / (2 pi GBW)),  behind `output_resistance_ohm`,
/// its rate of change limited to `slew_v_per_s` and its output to +-`swing_v`.
struct OpAmpModel {
  std::string name = "generic-10M";
  Hertz gain_bandwidth{10e6};
  double dc_gain = 1e6;
  double slew_v_per_s = 20e6;
  double output_resistance_ohm = 50.0;
  double swing_v = 14.1;  ///< greatest output either side of ground
  double bias_current_a = 10e-12;
  double offset_v = 0.5e-3;
  double voltage_noise_v_per_rthz = 8e-9;
  double voltage_noise_corner_hz = 100.0;  ///< 1/f corner of the voltage noise
  double current_noise_a_per_rthz = 1e-15;
  double greatest_output_current_a = 20e-3;
  int per_package = 1;  ///< op-amps in one 8-pin package: 1 or 2
  /// Stands for a nullor: its figures are far beyond any that matter, netlists have a plain source.
  bool is_ideal = false;

  /// The type "ideal".
  static OpAmpModel ideal();

  std::complex<double> open_loop(RadPerSecond w) const;
};

}  // namespace bodesmith::schematic
