#include "simulate/pid.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::simulate {
namespace {

/// How much of the integral's rate is left this far beyond a limit into which it runs. The step from all to nothing would have
/// the loop slide along it, without end for a solver: a millionth of the limits' size (of 1 where they have none) is no part of any
/// figure.
double part_left(double beyond, const PidController& c) {
  const double low = std::isfinite(c.lower) ? std::abs(c.lower) : 0.0;
  const double high = std::isfinite(c.upper) ? std::abs(c.upper) : 0.0;
  const double size = std::max(low, high);
  return std::clamp(1.0 - beyond / (1e-6 * (size > 0.0 ? size : 1.0)), 0.0, 1.0);
}

}  // namespace

double continuous_control(const PidController& c, double error, const double* states, double* rates) {
  const double wd = c.derivative_corner.rad_s().value;
  const double free = c.proportional * error + states[0] + c.derivative_s * wd * (error - states[1]);
  rates[0] = c.integral_per_s * error;
  if (c.limited()) rates[0] *= part_left(rates[0] > 0.0 ? free - c.upper : c.lower - free, c);
  rates[1] = c.derivative_s == 0.0 ? 0.0 : wd * (error - states[1]);
  return std::clamp(free, c.lower, c.upper);
}

double continuous_control_slope(const PidController& c, double error_slope, const double* rates) {
  const double wd = c.derivative_corner.rad_s().value;
  return c.proportional * error_slope + rates[0] + c.derivative_s * wd * (error_slope - rates[1]);
}

double SampledPid::update(double error) {
  const PidController& c = controller_;
  if (!started_) last_error_ = error;
  const double wd = c.derivative_corner.rad_s().value * c.period_s;
  const double before = integral_;
  if (started_) integral_ += 0.5 * c.integral_per_s * c.period_s * (error + last_error_);
  derivative_ = (derivative_ + c.derivative_s * wd / c.period_s * (error - last_error_)) / (1.0 + wd);
  const double free = c.proportional * error + integral_ + derivative_;
  const bool into_upper = free > c.upper && integral_ > before;
  const bool into_lower = free < c.lower && integral_ < before;
  if (into_upper || into_lower) integral_ = before;
  last_error_ = error;
  started_ = true;
  return std::clamp(free, c.lower, c.upper);
}

}  // namespace bodesmith::simulate
