#include "schematic/opamp_model.hpp"

namespace bodesmith::schematic {

std::complex<double> OpAmpModel::open_loop(RadPerSecond w) const {
  return dc_gain / std::complex<double>(1.0, w.value * dc_gain / gain_bandwidth.rad_s().value);
}

OpAmpModel OpAmpModel::ideal() {
  OpAmpModel out;
  out.name = "ideal";
  out.is_ideal = true;
  out.gain_bandwidth = Hertz{1e15};
  out.dc_gain = 1e12;
  out.slew_v_per_s = 1e18;
  out.swing_v = 1e6;
  out.output_resistance_ohm = out.bias_current_a = out.offset_v = 0.0;
  out.voltage_noise_v_per_rthz = out.current_noise_a_per_rthz = 0.0;
  out.greatest_output_current_a = 1e6;
  return out;
}

}  // namespace bodesmith::schematic
