#pragma once

#include <complex>
#include <vector>

#include "base/units.hpp"

namespace bodesmith {

/// coefficient * s^power; s^power is the principal one, cut along the negative real axis.
struct FractionalPower {
  double coefficient = 1.0;
  double power = 0.0;
};

/// sum_k a_k s^alpha_k.
using FractionalPolynomial = std::vector<FractionalPower>;

/// Its value at s = jw.
std::complex<double> evaluate(const FractionalPolynomial& polynomial, RadPerSecond w);

/// Equal powers joined, zeros dropped, powers rising.
FractionalPolynomial collect_powers(FractionalPolynomial polynomial);

}  // namespace bodesmith
