#pragma once

#include <cmath>
#include <vector>

#include "hysteresis/fractional_dynamic.hpp"
#include "numeric/grunwald_letnikov.hpp"

namespace bodesmith::hysteresis {

/// Grünwald-Letnikov (eq. 2) for the whole of eq. 15, zero initial state, all the past: O(n²). Every sample
/// is split into `refine` steps with u linear between. First order in the step: the paper's own 0.1 ms is
/// 0.08 of its resonance's period.
inline std::vector<double> simulate_grunwald_letnikov(const FractionalDynamic& model,
                                                      const std::vector<double>& u, double step_s,
                                                      int refine) {
  const auto parts = static_cast<std::size_t>(refine);
  const double h = step_s / refine;
  const std::vector<double> fine = straight_between(u, parts);
  const auto weights = [&](const FractionalPolynomial& polynomial) {
    std::vector<double> out(fine.size(), 0.0);
    for (const FractionalPower& term : polynomial)
      add_difference_weights(term.coefficient * std::pow(h, -term.power), term.power, out);
    return out;
  };
  const std::vector<double> a = weights(model.denominator());
  const std::vector<double> b = weights({{model.k_m * model.k_p, 0.0}, {model.k_m * model.theta, model.eta}});
  std::vector<double> y(fine.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    double sum = sum_over_past(b, fine, i);
    for (std::size_t j = 1; j <= i; ++j) sum -= a[j] * y[i - j];
    y[i] = sum / a[0];
  }
  std::vector<double> out(u.size());
  for (std::size_t i = 0; i < u.size(); ++i)
    out[i] = y[i * parts] + model.rho * step_s * static_cast<double>(i) + model.delta;
  return out;
}

}  // namespace bodesmith::hysteresis
