#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/whole_number.hpp"
#include "lti/cascade.hpp"
#include "numeric/grunwald_letnikov.hpp"

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

/// Power series of (c (1 - a z)/(1 - b z))^beta: with g its logarithmic derivative, (1 - (a+b) z + ab z^2) f'
/// = beta (b - a) f.
inline std::vector<double> series(const FractionalLeadLag& term, double h, std::size_t count) {
  const double first = term.lambda_s / h;
  const double second = term.x * term.lambda_s / h;
  const double a = first / (1.0 + first);
  const double b = second / (1.0 + second);
  std::vector<double> f(count);
  f[0] = std::pow((1.0 + first) / (1.0 + second), term.beta);
  for (std::size_t k = 1; k < count; ++k) {
    const double n = static_cast<double>(k);
    double sum = (term.beta * (b - a) + (a + b) * (n - 1.0)) * f[k - 1];
    if (k > 1) sum -= a * b * (n - 2.0) * f[k - 2];
    f[k] = sum / n;
  }
  return f;
}

/// Outputs at the samples, u refined to `parts` steps a sample.
inline std::vector<double> convolved(const std::vector<double>& f, std::span<const double> u,
                                     std::size_t parts) {
  const std::vector<double> in = straight_between(u, parts);
  std::vector<double> y(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) y[i] = sum_over_past(f, in, i * parts);
  return y;
}

/// Zero before the first sample. memory_s <= 0: the whole past.
inline GrunwaldLetnikovResult grunwald_letnikov(const FractionalLeadLag& term, std::span<const double> u,
                                                double step_s, double memory_s = 0.0,
                                                bool extrapolate = true) {
  GrunwaldLetnikovResult out;
  if (u.empty()) return out;
  const auto run = [&](std::size_t parts) {
    const double h = step_s / static_cast<double>(parts);
    const std::size_t all = (u.size() - 1) * parts + 1;
    const std::vector<double> whole = series(term, h, all);
    std::vector<double> used = whole;
    if (memory_s > 0.0) used.resize(whole_number<std::size_t>(std::ceil(memory_s / h), 1, all));
    double tail = 0.0;
    for (std::size_t k = used.size(); k < whole.size(); ++k) tail += std::abs(whole[k]);
    double largest = 0.0;
    for (const double v : u) largest = std::max(largest, std::abs(v));
    out.memory_bound = std::max(out.memory_bound, tail * largest * (extrapolate ? 3.0 : 1.0));
    return convolved(used, u, parts);
  };
  out.y = run(1);
  if (!extrapolate) return out;
  const std::vector<double> fine = run(2);
  for (std::size_t i = 0; i < u.size(); ++i) out.y[i] = 2.0 * fine[i] - out.y[i];
  return out;
}

}  // namespace bodesmith::simulate
