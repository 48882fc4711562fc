#include "spice/deck_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"

namespace bodesmith {
namespace {

std::string factors(const std::vector<std::complex<double>>& roots) {
  if (roots.empty()) return "1";
  if (std::abs(roots[0]) == 0.0 && std::abs(roots.back()) == 0.0) return roots.size() == 1 ? "s" : "s^2";
  if (roots[0].imag() != 0.0) {
    return fmt::format("(s^2 + {}s + {})", rounded_text(-2.0 * roots[0].real(), 6),
                       rounded_text(std::norm(roots[0]), 6));
  }
  std::string out;
  for (const auto& root : roots) {
    out += root.real() > 0.0 ? fmt::format("(s - {})", rounded_text(root.real(), 6))
                             : fmt::format("(s + {})", rounded_text(-root.real(), 6));
  }
  return out;
}

}  // namespace

std::string spice_number(double value) {
  return fmt::format("{:.12g}", value);
}

std::string opamp_library(const OpAmpModel& model) {
  if (model.name == "ideal") return render_template("spice/ideal_opamp.sub", {});
  constexpr double kIntegrator = 1e-9;
  const double gbw = model.gain_bandwidth.rad_s().value;
  Json data;
  data["name"] = model.name;
  data["gbw_hz"] = spice_number(model.gain_bandwidth.value);
  data["dc_gain"] = spice_number(model.dc_gain);
  data["slew_v_per_s"] = spice_number(model.slew_v_per_s);
  data["swing_v"] = spice_number(model.swing_v);
  data["output_resistance_ohm"] = spice_number(model.output_resistance_ohm);
  data["slew_current_a"] = spice_number(model.slew_v_per_s * kIntegrator);
  data["slope_per_v"] = spice_number(gbw / model.slew_v_per_s);
  data["integrator_ohm"] = spice_number(model.dc_gain / (gbw * kIntegrator));
  data["integrator_f"] = spice_number(kIntegrator);
  // 1 mV beyond the limit takes the whole slewing current.
  data["clamp_siemens"] = spice_number(model.slew_v_per_s * kIntegrator / 1e-3);
  // Noise as that of resistors: 4 k T R = e^2.
  constexpr double k4T = 4.0 * 1.380649e-23 * 300.15;
  data["voltage_noise"] = model.voltage_noise_v_per_rthz > 0.0;
  data["voltage_noise_v_per_rthz"] = spice_number(model.voltage_noise_v_per_rthz);
  const double white = std::pow(model.voltage_noise_v_per_rthz, 2);
  // The part that falls with frequency is that of two diodes in opposition, which all three simulators have:
  // current noise KF I/f behind r = kT/(q I) each. Their shot noise, 2 q I, is taken off the resistor's.
  constexpr double kCharge = 1.602176634e-19, kThermalV = 1.380649e-23 * 300.15 / kCharge;
  constexpr double kDiodeA = 0.1, kDiodeOhm = kThermalV / kDiodeA;
  const bool flicker = white > 0.0 && model.voltage_noise_corner_hz > 0.0;
  const double shot = flicker ? 2.0 * 2.0 * kCharge * kDiodeA * kDiodeOhm * kDiodeOhm : 0.0;
  data["flicker"] = flicker;
  data["corner_hz"] = spice_number(model.voltage_noise_corner_hz);
  data["diode_a"] = spice_number(kDiodeA);
  data["kf"] = spice_number(white * model.voltage_noise_corner_hz / (2.0 * kDiodeOhm * kDiodeOhm * kDiodeA));
  data["flicker_term"] = flicker ? "+v(d1)-v(d2)" : "";
  data["noise_ohm"] = spice_number(std::max(white - shot, 1e-3 * white) / k4T);
  data["current_noise"] = model.current_noise_a_per_rthz > 0.0;
  constexpr double kUnit = 1e3;
  data["unit_ohm"] = spice_number(kUnit);
  data["current_noise_siemens"] = spice_number(model.current_noise_a_per_rthz / std::sqrt(k4T * kUnit));
  return render_template("spice/opamp.sub", data);
}

std::string transfer_text(const std::vector<Biquad>& product) {
  double gain = 1.0;
  std::string zeros, poles;
  for (const Biquad& h : product) {
    const Section section = h.section();
    gain *= section.gain;
    zeros += factors(section.zeros);
    poles += factors(section.poles);
  }
  return fmt::format("{} {}/{}", rounded_text(gain, 6), zeros, poles);
}

}  // namespace bodesmith
