#include "multiplier_layout/slope_detector.hpp"

#include <algorithm>
#include <cmath>

#include "schematic/analysis/in_time.hpp"
#include "schematic/analysis/noise.hpp"

namespace bodesmith::multiplier_layout {
SlopeDetector::SlopeDetector(schematic::Netlist detector, std::string input)
    : netlist_(std::move(detector)), input_(std::move(input)) {}

double SlopeDetector::threshold_v() const {
  return model().swing_v * hysteresis();
}

double SlopeDetector::vt() const {
  return netlist_.diode.emission * schematic::kBoltzmann * schematic::kKelvin / schematic::kElectron;
}

double SlopeDetector::feedback_a(double v) const {
  // exp is limited: at 40 vt the diode would carry kiloamperes.
  return v / value("Rd") + 2.0 * netlist_.diode.saturation_a * std::sinh(std::clamp(v / vt(), -40.0, 40.0));
}

double SlopeDetector::noise_v() const {
  constexpr int kPoints = 425;  // 50 to a decade
  return schematic::output_noise_rms(netlist_, {Hertz{0.1}, Hertz{30e6}}, true, "sc", kPoints, input_);
}

std::vector<double> SlopeDetector::gains(const std::vector<Hertz>& grid) const {
  const schematic::Equations equations(netlist_, {.input = input_});
  std::vector<double> out;
  for (const Hertz f : grid) out.push_back(std::abs(equations.response(f.rad_s(), "sc")));
  return out;
}

std::optional<double> SlopeDetector::delay_s(const std::function<double(double)>& x, double start_s,
                                             double reversal_s, double stop_s) const {
  schematic::InTime run(netlist_, x, {.input = input_});
  run.begin(start_s, {{netlist_.part_named("Cd")->from, x(start_s)}, {"so", -model().swing_v}});
  run.run_to(reversal_s);
  const std::optional<double> at = run.rises("so", stop_s);
  return at ? std::optional(*at - reversal_s) : std::nullopt;
}

}  // namespace bodesmith::multiplier_layout
