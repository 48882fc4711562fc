#pragma once

#include "approximate/method.hpp"

namespace bodesmith {

/// Recursive poles and zeros, evenly spaced in log frequency, k = 1..n:
///   w_k = kappa^((2k - 1)/(2n) - 1/2),  zero_k = -w_k kappa^(-beta/(2n)),  pole_k = -w_k kappa^(beta/(2n)).
NormalisedApproximation oustaloup_recursion(double kappa, double beta, int order);

}  // namespace bodesmith
