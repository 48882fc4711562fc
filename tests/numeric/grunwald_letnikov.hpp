#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace bodesmith {

// Grünwald and Letnikov's fractional differences: D^a x(t) is the limit of h^-a sum_j (-1)^j binom(a, j) x(t
// - j h), a convolution with all the past (Podlubny, Fractional Differential Equations, 1999, ch. 2.2). First
// order in h.

/// Adds factor (-1)^j binom(order, j) to weights[j]; `factor` is coefficient h^-order for a term of an
/// equation.
inline void add_difference_weights(double factor, double order, std::span<double> weights) {
  double w = factor;
  for (std::size_t j = 0; j < weights.size() && w != 0.0; ++j) {
    weights[j] += w;
    w *= 1.0 - (order + 1.0) / static_cast<double>(j + 1);
  }
}

/// The samples and parts - 1 values on the straight line between each and the next.
inline std::vector<double> straight_between(std::span<const double> samples, std::size_t parts) {
  if (samples.empty()) return {};
  std::vector<double> out((samples.size() - 1) * parts + 1);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t k = i / parts;
    const double part = static_cast<double>(i % parts) / static_cast<double>(parts);
    out[i] = part > 0.0 ? samples[k] + part * (samples[k + 1] - samples[k]) : samples[k];
  }
  return out;
}

/// sum_j weights[j] x[now - j] over the weights and the past there are.
inline double sum_over_past(std::span<const double> weights, std::span<const double> x, std::size_t now) {
  const std::size_t used = std::min(now + 1, weights.size());
  double sum = 0.0;
  for (std::size_t j = 0; j < used; ++j) sum += weights[j] * x[now - j];
  return sum;
}

}  // namespace bodesmith
