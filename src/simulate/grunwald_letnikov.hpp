#pragma once

#include <span>
#include <vector>

#include "lti/fractional_lead_lag.hpp"

namespace bodesmith::simulate {

/// A fractional lead-lag ((lambda s + 1)/(x lambda s + 1))^beta in time, by Grunwald-Letnikov's generalised
/// differences: with s -> (1 - z^-1)/h the term is (c (1 - a z^-1)/(1 - b z^-1))^beta, whose power series in
/// z^-1 is its impulse response (exact coefficients by a three-term recursion). First order in h;
/// `extrapolate` runs h/2 as well (input linear between samples) and combines both to second order. A
/// reference to check approximations with, cost samples x memory.
///
/// Short memory (Podlubny 1999, sec. 7.3): only the last memory_s seconds are summed; what is left out is at
/// most the tail of the impulse response times the largest input, stated in the result.
struct GrunwaldLetnikovResult {
  std::vector<double> y;
  double memory_bound = 0.0;  ///< bound on what the short memory left out
};

/// Zero before the first sample. memory_s <= 0: the whole past.
GrunwaldLetnikovResult grunwald_letnikov(const FractionalLeadLag& term, std::span<const double> u,
                                         double step_s, double memory_s = 0.0, bool extrapolate = true);

}  // namespace bodesmith::simulate
