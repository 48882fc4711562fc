#include "tuning/controller_kind.hpp"

#include "numeric/quadratic_roots.hpp"

namespace bodesmith::tuning {
namespace {

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
    one.zeros = quadratic_roots(ki, kp, 0.0);
    one.poles = {Complex(0.0, 0.0)};
  } else {
    const double a = kp + pid.derivative_s * corner;
    const double b = kp * corner + ki;
    one.gain = leading(a, b, ki * corner);
    one.zeros = quadratic_roots(ki * corner, b, a);
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
