#pragma once

#include <complex>

#include "lti/sections.hpp"
#include "simulate/pid.hpp"

namespace bodesmith::tuning {

/// C(s) = (kp + ki/s + kd s/(1 + s/w_d)) filter(s): what `simulate --controller` runs.
struct SeriesController {
  simulate::PidController pid;
  Sections filter;  ///< gain 1 and no sections: none

  std::complex<double> response(std::complex<double> s) const;
  /// The whole as sections, the integrator a pole at 0.
  Sections sections() const;
};

}  // namespace bodesmith::tuning
