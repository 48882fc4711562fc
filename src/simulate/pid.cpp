#include "simulate/pid.hpp"

#include <algorithm>

namespace bodesmith::simulate {

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
