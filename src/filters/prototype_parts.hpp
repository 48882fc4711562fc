#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "filters/family.hpp"

/// What several families need, for their own files only.
namespace bodesmith::filters {

/// cos and sin of pi (2 i + 1)/(2 order), i = 0 ... order/2 - 1: the upper half of the Butterworth circle, without the
/// middle one of an odd order.
std::vector<std::complex<double>> upper_unit_points(int order);

/// Adds root and its conjugate.
void add_pair(std::vector<std::complex<double>>& roots, std::complex<double> root);

/// prod (-root); real for roots in conjugate pairs.
double product_of_negatives(const std::vector<std::complex<double>>& roots);

/// All-pole prototype of gain 1 at 0 Hz.
Prototype all_pole(std::vector<std::complex<double>> poles);

/// The all-pole prototype whose half-power frequency is brought to 1 rad/s.
Prototype half_power_at_one(std::vector<std::complex<double>> poles);

using LongComplex = std::complex<long double>;
/// Value and derivative of a polynomial.
struct PolynomialValue {
  LongComplex value;
  LongComplex derivative;
};
/// All roots of a real polynomial of that degree with no real root but the one an odd degree must have, by Aberth's
/// simultaneous iteration from a circle of that radius, upper half plane first mirrored exactly. Left as they are after
/// 200 rounds (orders here converge in about 20).
std::vector<std::complex<double>> conjugate_roots(
    int degree, long double radius, const std::function<PolynomialValue(LongComplex)>& polynomial);

/// Roots of the reverse Bessel polynomial theta_N, theta_0 = 1, theta_1 = s + 1,
/// theta_n = (2n - 1) theta_(n-1) + s^2 theta_(n-2): the poles of unit group delay at 0 Hz.
std::vector<std::complex<double>> bessel_poles(int order);

}  // namespace bodesmith::filters
