#include "schematic/writers/spice_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "base/text_template.hpp"
#include "schematic/elements/element.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::schematic {
namespace {

std::string without_end(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace

std::string opamp_subcircuit(const OpAmpModel& model, const std::string& subcircuit) {
  if (model.is_ideal)
    return without_end(render_template("spice/ideal_opamp.sub", {{"subcircuit", subcircuit}}));
  constexpr double kIntegrator = 1e-9;
  const double gbw = model.gain_bandwidth.rad_s().value;
  Json data = {{"subcircuit", subcircuit},
               {"name", model.name},
               {"gbw_hz", plain_number(model.gain_bandwidth.value)},
               {"dc_gain", plain_number(model.dc_gain)},
               {"slew_v_per_s", plain_number(model.slew_v_per_s)},
               {"swing_v", plain_number(model.swing_v)},
               {"output_resistance_ohm", plain_number(model.output_resistance_ohm)},
               {"slew_current_a", plain_number(model.slew_v_per_s * kIntegrator)},
               {"slope_per_v", plain_number(gbw / model.slew_v_per_s)},
               {"integrator_ohm", plain_number(model.dc_gain / (gbw * kIntegrator))},
               {"integrator_f", plain_number(kIntegrator)}};
  // 1 mV beyond the limit takes the whole slewing current.
  data["clamp_siemens"] = plain_number(model.slew_v_per_s * kIntegrator / 1e-3);
  // Noise as that of resistors: 4 k T R = e^2.
  constexpr double k4T = 4.0 * kBoltzmann * kKelvin;
  data["voltage_noise"] = model.voltage_noise_v_per_rthz > 0.0;
  data["voltage_noise_v_per_rthz"] = plain_number(model.voltage_noise_v_per_rthz);
  const double white = std::pow(model.voltage_noise_v_per_rthz, 2);
  // The part that falls with frequency is that of two diodes in opposition, which all three simulators have:
  // current noise KF I/f behind r = kT/(q I) each. Their shot noise, 2 q I, is taken off the resistor's.
  constexpr double kThermalV = kBoltzmann * kKelvin / kElectron;
  constexpr double kDiodeA = 0.1, kDiodeOhm = kThermalV / kDiodeA;
  const bool flicker = white > 0.0 && model.voltage_noise_corner_hz > 0.0;
  const double shot = flicker ? 2.0 * 2.0 * kElectron * kDiodeA * kDiodeOhm * kDiodeOhm : 0.0;
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
  return without_end(render_template("spice/opamp.sub", data));
}

std::string multiplier_subcircuit(const MultiplierModel& model, const std::string& name,
                                  const MultiplierDeviation& off) {
  Json data = {{"name", name},
               {"multiplier", model.name},
               {"scale_v", plain_number(model.scale_v)},
               {"spoilt", off.any()},
               {"input_offset_v", plain_number(off.x)},
               {"second_offset_v", plain_number(off.y)},
               {"output_offset_v", plain_number(off.w)},
               {"inverse_scale", plain_number(1.0 / model.scale_v * (1.0 + off.bend) / (1.0 + off.scale))},
               {"bandwidth_hz", plain_number(model.bandwidth.value)},
               {"pole_f", plain_number(1.0 / model.bandwidth.rad_s().value)},
               {"limit_v", plain_number(model.greatest_output_v)}};
  return without_end(render_template("spice/multiplier.sub", data));
}

std::string switch_subcircuit(const SwitchModel& model) {
  const SwitchTimer timer = SwitchTimer::of(model);
  Json data = {{"charge_c", plain_number(model.charge_c)},
               {"off_siemens", plain_number(model.off_siemens)},
               {"on_siemens", plain_number(model.on_siemens())},
               {"level", plain_number(timer.level)},
               {"timer_f", plain_number(timer.tau_s / 1000.0)},
               {"charge_f", plain_number(model.gate_f())},
               {"source_f", plain_number(model.source_f)},
               {"drain_f", plain_number(std::max(model.drain_f - model.gate_f(), 0.0))}};
  return without_end(render_template("spice/switch.sub", data));
}

std::string diode_model(const DiodeModel& model) {
  return fmt::format(".model bodesmith_diode D(IS={} N={} RS={} CJO={} TT={})",
                     plain_number(model.saturation_a), plain_number(model.emission),
                     plain_number(model.series_ohm), plain_number(model.junction_f),
                     plain_number(model.transit_s));
}

}  // namespace bodesmith::schematic
