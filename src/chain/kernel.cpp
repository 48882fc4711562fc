#include "chain/kernel.hpp"

#include <cmath>

namespace bodesmith::chain {

LinearKernel gain_kernel(double gain, double offset) {
  return {gain_system(gain, offset)};
}

LinearKernel pole_zero_kernel(double gain, double zero_rad_s, double pole_rad_s) {
  // x' = pole (u - x)
  const double direct = std::isinf(zero_rad_s) ? 0.0 : pole_rad_s / zero_rad_s;
  LinearKernel k;
  k.a = {-pole_rad_s};
  k.b = {pole_rad_s};
  k.c = {gain * (1.0 - direct)};
  k.d = gain * direct;
  return k;
}

LinearKernel in_series(const LinearKernel& first, const LinearKernel& second) {
  return {bodesmith::in_series(static_cast<const StateSpace&>(first), second), first.delay_s + second.delay_s,
          first.approximation_error + second.approximation_error};
}

double mode_time_constant_s(Hertz natural_frequency, double damping_ratio) {
  const double d = damping_ratio;
  return 1.0 / (natural_frequency.rad_s().value * (d < 1.0 ? d : d - std::sqrt(d * d - 1.0)));
}

Complex response(const LinearKernel& kernel, Complex s) {
  return bodesmith::response(static_cast<const StateSpace&>(kernel), s) * std::exp(-s * kernel.delay_s);
}

}  // namespace bodesmith::chain
