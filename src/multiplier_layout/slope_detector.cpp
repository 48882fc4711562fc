#include "multiplier_layout/slope_detector.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace bodesmith::multiplier_layout {
namespace {

constexpr double kBoltzmann = 1.380649e-23;
constexpr double kKelvin = 300.15;
constexpr double kCharge = 1.602176634e-19;
/// Steps to a decade of the noise integral.
constexpr int kPerDecade = 50;

constexpr int kMostSteps = 200000;

using State = Eigen::Matrix<double, 4, 1>;  // Cd, Cf, differentiator's op-amp, comparator
using Jacobian = Eigen::Matrix<double, 4, 4>;

}  // namespace

SlopeDetector::SlopeDetector(const Layout& layout, const DiodeModel& diode)
    : opamp_(layout.opamp), diode_(diode), vt_(diode.emission * kBoltzmann * kKelvin / kCharge) {
  const auto value = [&](const char* name) { return layout.part_named(name)->realised; };
  rs_ = value("Rs");
  cd_ = value("Cd");
  rd_ = value("Rd");
  cf_ = value("Cf");
  hysteresis_ = value("Rh1") / (value("Rh1") + value("Rh2"));
}

double SlopeDetector::threshold_v() const {
  return opamp_.swing_v * hysteresis_;
}

double SlopeDetector::feedback_a(double v) const {
  // exp is limited: at 40 vt the diode would carry kiloamperes.
  return v / rd_ + 2.0 * diode_.saturation_a * std::sinh(std::clamp(v / vt_, -40.0, 40.0));
}

double SlopeDetector::feedback_f(double v) const {
  const auto junction = [&](double at) {
    // SPICE: linear beyond half the built-in 1 V.
    return at < 0.5 ? diode_.junction_f / std::sqrt(1.0 - at)
                    : diode_.junction_f / std::sqrt(0.5) * (1.0 + (at - 0.5));
  };
  const double conductance = 2.0 * diode_.saturation_a / vt_ * std::cosh(std::clamp(v / vt_, -40.0, 40.0));
  return cf_ + junction(v) + junction(-v) + diode_.transit_s * conductance;
}

SlopeDetector::Loop SlopeDetector::loop(RadPerSecond w) const {
  const std::complex<double> s(0.0, w.value);
  const double siemens = 1.0 / rd_ + 2.0 * diode_.saturation_a / vt_;
  Loop out;
  out.feedback = 1.0 / (siemens + s * feedback_f(0.0));
  out.input = rs_ + 1.0 / (s * cd_);
  const std::complex<double> around = 1.0 + out.feedback / out.input;
  out.closed = 1.0 / (1.0 + around / opamp_.open_loop(w));
  return out;
}

double SlopeDetector::gain(Hertz f) const {
  const Loop one = loop(f.rad_s());
  return std::abs(one.feedback / one.input * one.closed);
}

double SlopeDetector::noise_v() const {
  double sum = 0.0;
  const double step = std::pow(10.0, 1.0 / kPerDecade);
  for (double f = 0.1; f < 30e6; f *= step) {
    const double middle = f * std::sqrt(step);
    const Loop one = loop(Hertz{middle}.rad_s());
    const double en2 =
        std::pow(opamp_.voltage_noise_v_per_rthz, 2) * (1.0 + opamp_.voltage_noise_corner_hz / middle);
    // Rd's thermal noise, shot noise of both diodes' saturation currents, the op-amp's current noise.
    const double in2 = 4.0 * kBoltzmann * kKelvin / rd_ + 4.0 * kCharge * diode_.saturation_a +
                       std::pow(opamp_.current_noise_a_per_rthz, 2);
    sum += (en2 * std::norm((1.0 + one.feedback / one.input) * one.closed) +
            in2 * std::norm(one.feedback * one.closed)) *
           f * (step - 1.0);
  }
  return std::sqrt(sum);
}

std::optional<double> SlopeDetector::delay_s(const std::function<double(double)>& x, double start_s,
                                             double reversal_s, double stop_s) const {
  const double gbw = opamp_.gain_bandwidth.rad_s().value, slew = opamp_.slew_v_per_s;
  const auto integrator = [&](double difference, double v) {
    const double rate = slew * std::tanh(gbw * difference / slew) - v * gbw / opamp_.dc_gain;
    // At its limit it stays: the netlist's clamp is a millivolt wide, which would only cost steps.
    return std::abs(v) >= opamp_.swing_v && rate * v > 0.0 ? 0.0 : rate;
  };
  const double input_ohm = rs_ + opamp_.output_resistance_ohm;
  const auto slope = [&](double t, const State& u) {
    const double i = (x(t) - u[0] - u[1] - u[2]) / input_ohm;
    const double end = u[2] + opamp_.output_resistance_ohm * i;
    State out;
    out << i / cd_, (i - feedback_a(u[1])) / feedback_f(u[1]), integrator(-(u[1] + end), u[2]),
        integrator(hysteresis_ * u[3] - end, u[3]);
    return out;
  };
  double t = start_s, h = 1e-9;
  State u, scale;
  u << x(start_s), 0.0, 0.0, -opamp_.swing_v;
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
