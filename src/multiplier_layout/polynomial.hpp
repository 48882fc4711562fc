#pragma once

#include <vector>

namespace bodesmith::multiplier_layout {

/// Steps of x over [0, 1] where polynomials are compared.
constexpr int kPolynomialPoints = 1000;

/// a[0] x + a[1] x^2 + …
double polynomial(const std::vector<double>& a, double x);
/// Greatest |f| over x in [0, 1].
double peak(const std::vector<double>& a);
/// Number of coefficients without trailing zeros.
int degree(const std::vector<double>& a);

}  // namespace bodesmith::multiplier_layout
