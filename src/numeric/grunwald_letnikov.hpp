#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace bodesmith {

// Grünwald and Letnikov's fractional differences: D^a x(t) is the limit of h^-a sum_j (-1)^j binom(a, j) x(t
// - j h), a convolution with all the past (Podlubny, Fractional Differential Equations, 1999, ch. 2.2). First
// order in h.

/// Adds factor (-1)^j binom(order, j) to weights[j]; `factor` is coefficient h^-order for a term of an
/// equation.
void add_difference_weights(double factor, double order, std::span<double> weights);

/// The samples and parts - 1 values on the straight line between each and the next.
std::vector<double> straight_between(std::span<const double> samples, std::size_t parts);

/// sum_j weights[j] x[now - j] over the weights and the past there are.
double sum_over_past(std::span<const double> weights, std::span<const double> x, std::size_t now);

}  // namespace bodesmith
