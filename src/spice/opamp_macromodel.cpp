#include "spice/opamp_macromodel.hpp"

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "base/text_template.hpp"
#include "circuit/text.hpp"

namespace bodesmith::spice {

using circuit::plain_number;

std::string opamp_macromodel(const circuit::OpAmpModel& model, const std::string& subcircuit) {
  if (model.is_ideal) return render_template("spice/ideal_opamp.sub", {{"subcircuit", subcircuit}});
  constexpr double kIntegrator = 1e-9;
  const double gbw = model.gain_bandwidth.rad_s().value;
  Json data;
  data["subcircuit"] = subcircuit;
  data["name"] = model.name;
  data["gbw_hz"] = plain_number(model.gain_bandwidth.value);
  data["dc_gain"] = plain_number(model.dc_gain);
  data["slew_v_per_s"] = plain_number(model.slew_v_per_s);
  data["swing_v"] = plain_number(model.swing_v);
  data["output_resistance_ohm"] = plain_number(model.output_resistance_ohm);
  data["slew_current_a"] = plain_number(model.slew_v_per_s * kIntegrator);
  data["slope_per_v"] = plain_number(gbw / model.slew_v_per_s);
  data["integrator_ohm"] = plain_number(model.dc_gain / (gbw * kIntegrator));
  data["integrator_f"] = plain_number(kIntegrator);
  // 1 mV beyond the limit takes the whole slewing current.
  data["clamp_siemens"] = plain_number(model.slew_v_per_s * kIntegrator / 1e-3);
  // Noise as that of resistors: 4 k T R = e^2.
  constexpr double k4T = 4.0 * 1.380649e-23 * 300.15;
  data["voltage_noise"] = model.voltage_noise_v_per_rthz > 0.0;
  data["voltage_noise_v_per_rthz"] = plain_number(model.voltage_noise_v_per_rthz);
  const double white = std::pow(model.voltage_noise_v_per_rthz, 2);
  // The part that falls with frequency is that of two diodes in opposition, which all three simulators have:
  // current noise KF I/f behind r = kT/(q I) each. Their shot noise, 2 q I, is taken off the resistor's.
  constexpr double kCharge = 1.602176634e-19, kThermalV = 1.380649e-23 * 300.15 / kCharge;
  constexpr double kDiodeA = 0.1, kDiodeOhm = kThermalV / kDiodeA;
  const bool flicker = white > 0.0 && model.voltage_noise_corner_hz > 0.0;
  const double shot = flicker ? 2.0 * 2.0 * kCharge * kDiodeA * kDiodeOhm * kDiodeOhm : 0.0;
  data["flicker"] = flicker;
  data["corner_hz"] = plain_number(model.voltage_noise_corner_hz);
  data["diode_a"] = plain_number(kDiodeA);
  data["kf"] = plain_number(white * model.voltage_noise_corner_hz / (2.0 * kDiodeOhm * kDiodeOhm * kDiodeA));
  data["flicker_term"] = flicker ? "+v(d1)-v(d2)" : "";
  data["noise_ohm"] = plain_number(std::max(white - shot, 1e-3 * white) / k4T);
  data["current_noise"] = model.current_noise_a_per_rthz > 0.0;
  constexpr double kUnit = 1e3;
  data["unit_ohm"] = plain_number(kUnit);
  data["current_noise_siemens"] = plain_number(model.current_noise_a_per_rthz / std::sqrt(k4T * kUnit));
  return render_template("spice/opamp.sub", data);
}

}  // namespace bodesmith::spice
