#pragma once

#include <complex>

#include "base/units.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {

/// y = gain u + offset.
LinearKernel gain_kernel(double gain, double offset = 0.0);
/// gain (1 + s/zero)/(1 + s/pole), rad/s; zero = infinity: gain/(1 + s/pole).
LinearKernel pole_zero_kernel(double gain, double zero_rad_s, double pole_rad_s);
/// `first` feeding `second`: states of the first, then of the second; delays add (the first one's delay then
/// also holds back the second one's offset: engines that care keep those apart).
LinearKernel in_series(const LinearKernel& first, const LinearKernel& second);

/// The slower time constant of the poles of 1 + 2 zeta s/w + s^2/w^2, w = 2 pi f.
double mode_time_constant_s(Hertz natural_frequency, double damping_ratio);

/// H(s) of the kernel as it is, delay included, offset left out.
std::complex<double> response(const LinearKernel& kernel, std::complex<double> s);

}  // namespace bodesmith::chain
