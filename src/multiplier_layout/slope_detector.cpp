#include "multiplier_layout/slope_detector.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "schematic/analysis/noise.hpp"

namespace bodesmith::multiplier_layout {
namespace {

constexpr int kMostSteps = 200000;

using State = Eigen::Matrix<double, 4, 1>;  // Cd, Cf, differentiator's op-amp, comparator
using Jacobian = Eigen::Matrix<double, 4, 4>;

}  // namespace

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

double SlopeDetector::feedback_f(double v) const {
  const auto junction = [&](double at) {
    // SPICE: linear beyond half the built-in 1 V.
    return at < 0.5 ? netlist_.diode.junction_f / std::sqrt(1.0 - at)
                    : netlist_.diode.junction_f / std::sqrt(0.5) * (1.0 + (at - 0.5));
  };
  const double conductance =
      2.0 * netlist_.diode.saturation_a / vt() * std::cosh(std::clamp(v / vt(), -40.0, 40.0));
  return value("Cf") + junction(v) + junction(-v) + netlist_.diode.transit_s * conductance;
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
  const schematic::OpAmpModel& opamp = model();
  const double gbw = opamp.gain_bandwidth.rad_s().value, slew = opamp.slew_v_per_s, cd = value("Cd"),
               hysteresis_share = hysteresis();
  const auto integrator = [&](double difference, double v) {
    const double rate = slew * std::tanh(gbw * difference / slew) - v * gbw / opamp.dc_gain;
    // At its limit it stays: the netlist's clamp is a millivolt wide, which would only cost steps.
    return std::abs(v) >= opamp.swing_v && rate * v > 0.0 ? 0.0 : rate;
  };
  const double input_ohm = value("Rs") + opamp.output_resistance_ohm;
  const auto slope = [&](double t, const State& u) {
    const double i = (x(t) - u[0] - u[1] - u[2]) / input_ohm;
    const double end = u[2] + opamp.output_resistance_ohm * i;
    State out;
    out << i / cd, (i - feedback_a(u[1])) / feedback_f(u[1]), integrator(-(u[1] + end), u[2]),
        integrator(hysteresis_share * u[3] - end, u[3]);
    return out;
  };
  double t = start_s, h = 1e-9;
  State u, scale;
  u << x(start_s), 0.0, 0.0, -opamp.swing_v;
  scale << 1e-6, 1e-5, 1e-5, 1e-3;
  const double gamma = 1.0 - 1.0 / std::numbers::sqrt2;
  const double look = 1e-7 * (stop_s - start_s);  // for the slope of x
  for (int steps = 0; t < stop_s && steps < kMostSteps; ++steps) {
    // No step across the reversal: x has a corner there.
    const bool before = t < reversal_s;
    const double most = (before ? reversal_s : stop_s) - t;
    const bool last = h >= most;
    if (last) h = most;
    const State f0 = slope(t, u);
    Jacobian j;
    for (int k = 0; k < 4; ++k) {
      State v = u;
      const double d = 1e-7 * (1e-3 + std::abs(u[k]));
      v[k] += d;
      j.col(k) = (slope(t, v) - f0) / d;
    }
    // x enters beside the voltage of Cd only, with the other sign.
    const double x_slope = before ? (x(t) - x(t - look)) / look : (x(t + look) - x(t)) / look;
    const State f_time = -j.col(0) * x_slope;
    const Eigen::PartialPivLU<Jacobian> lu(Jacobian::Identity() - gamma * h * j);
    const State k1 = lu.solve(f0 + gamma * h * f_time);
    const State k2 = lu.solve(slope(t + h, u + h * k1) - 2.0 * k1 - gamma * h * f_time);
    const State next = u + h * (1.5 * k1 + 0.5 * k2);
    double error = 0.0;
    for (int k = 0; k < 4; ++k) {
      error = std::max(error, 0.5 * h * std::abs(k1[k] + k2[k]) / (scale[k] + 1e-3 * std::abs(next[k])));
    }
    if (!(error <= 1.0) && h > 1e-13) {
      h *= std::isfinite(error) ? std::max(0.2, 0.9 / std::sqrt(error)) : 0.2;
      continue;
    }
    if (!before && u[3] < 0.0 && next[3] >= 0.0) return t + h * -u[3] / (next[3] - u[3]) - reversal_s;
    u = next;
    t = last ? (before ? reversal_s : stop_s) : t + h;
    h *= std::min(4.0, 0.9 / std::sqrt(std::max(error, 1e-8)));
  }
  return std::nullopt;
}

}  // namespace bodesmith::multiplier_layout
