#pragma once

#include <complex>
#include <vector>

namespace bodesmith::filters {

/// Roots of the reverse Bessel polynomial theta_N, theta_0 = 1, theta_1 = s + 1,
/// theta_n = (2n - 1) theta_(n-1) + s^2 theta_(n-2): the poles of unit group delay at 0 Hz.
std::vector<std::complex<double>> bessel_poles(int order);

}  // namespace bodesmith::filters
