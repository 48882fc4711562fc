#pragma once

#include <cstddef>
#include <limits>

#include "base/units.hpp"

namespace bodesmith::simulate {

/// A PI or PID controller on the error e = r - y, in parallel form:
///   control = clamp(proportional e + integral ∫ e dt + derivative w_d s/(s + w_d) e, lower, upper).
/// While the clamp holds the control, the integral does not run further into it.
/// period_s = 0: continuous. Otherwise sampled at t = k period_s from the record's start and held: the
/// integral by trapezia, the derivative by backward differences.
struct PidController {
  double proportional = 0.0;
  double integral_per_s = 0.0;
  double derivative_s = 0.0;
  Hertz derivative_corner{1e4};
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double period_s = 0.0;

  bool limited() const {
    return lower > -std::numeric_limits<double>::infinity() ||
           upper < std::numeric_limits<double>::infinity();
  }
};

/// The continuous form's own states: the integral, and the error behind the derivative's filter.
inline constexpr std::size_t kPidStates = 2;
/// The control for the error and the states; their rates into `rates`.
double continuous_control(const PidController& controller, double error, const double* states, double* rates);
/// Its slope (the limits apart) for the error's slope and the rates of the states.
double continuous_control_slope(const PidController& controller, double error_slope, const double* rates);

/// The sampled form: one update a period, starting from rest (integral 0, no derivative at the first sample).
class SampledPid {
 public:
  explicit SampledPid(const PidController& controller) : controller_(controller) {}
  /// The control that is held until the next sample.
  double update(double error);

 private:
  PidController controller_;
  double integral_ = 0.0;
  double derivative_ = 0.0;
  double last_error_ = 0.0;
  bool started_ = false;
};

}  // namespace bodesmith::simulate
