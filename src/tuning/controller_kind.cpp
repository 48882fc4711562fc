#include "tuning/controller_kind.hpp"

#include <cmath>

namespace bodesmith::tuning {
namespace {

using Complex = std::complex<double>;

/// Roots of a s^2 + b s + c, leading coefficients of 0 left out; real ones without cancellation.
std::vector<Complex> roots_of(double a, double b, double c) {
  if (a == 0.0) return b == 0.0 ? std::vector<Complex>{} : std::vector<Complex>{-c / b};
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant < 0.0) {
    const Complex root(-b / (2.0 * a), std::sqrt(-discriminant) / (2.0 * a));
    return {root, std::conj(root)};
  }
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  return {q / a, q == 0.0 ? 0.0 : c / q};
}

/// The first that is not 0.
double leading(double a, double b, double c) {
  return a != 0.0 ? a : b != 0.0 ? b : c;
}

}  // namespace

Complex SeriesController::response(Complex s) const {
  const double corner = pid.derivative_corner.rad_s().value;
  return (pid.proportional + pid.integral_per_s / s + pid.derivative_s * s / (1.0 + s / corner)) *
         filter.response(s);
}

Sections SeriesController::sections() const {
  Sections out = filter;
  Section one;
  const double corner = pid.derivative_corner.rad_s().value;
  const double kp = pid.proportional;
  const double ki = pid.integral_per_s;
  if (pid.derivative_s == 0.0) {
    one.gain = leading(0.0, kp, ki);
    one.zeros = roots_of(0.0, kp, ki);
    one.poles = {Complex(0.0, 0.0)};
  } else {
    const double a = kp + pid.derivative_s * corner;
    const double b = kp * corner + ki;
    one.gain = leading(a, b, ki * corner);
    one.zeros = roots_of(a, b, ki * corner);
    one.poles = {Complex(0.0, 0.0), Complex(-corner, 0.0)};
  }
  out.sections.insert(out.sections.begin(), one);
  return out;
}

const ControllerKind& pid_kind();
const ControllerKind& fractional_pid_kind();
const ControllerKind& notch_lead_kind();

const std::vector<const ControllerKind*>& controller_kinds() {
  static const std::vector<const ControllerKind*> all = {&pid_kind(), &fractional_pid_kind(),
                                                         &notch_lead_kind()};
  return all;
}

}  // namespace bodesmith::tuning
