#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lti/sections.hpp"

namespace bodesmith {

/// One input, one output:
///   x' = A x + b u + constant
///   y  = c x + d u + offset
///
/// | name     | shape         |                                    |
/// |----------|---------------|------------------------------------|
/// | a        | order x order | row-major                          |
/// | b, c     | order         |                                    |
/// | constant | order         | empty: zero                        |
/// | d        | 1             | 0: strictly proper                 |
///
/// States are chosen of the size of the signal, so that A is balanced. Arrays of states below have `order`
/// values; nothing but in_series(), state_space(), response() and equilibrium() allocates.
struct StateSpace {
  std::vector<double> a;
  std::vector<double> b;
  std::vector<double> c;
  std::vector<double> constant;
  double d = 0.0;
  double offset = 0.0;

  std::size_t order() const { return b.size(); }
  bool operator==(const StateSpace&) const = default;
};

/// y for the states x under the input u.
inline double output(const StateSpace& system, double u, const double* x) {
  double y = system.d * u + system.offset;
  for (std::size_t i = 0; i < system.c.size(); ++i) y += system.c[i] * x[i];
  return y;
}

/// y' for the rates dx of the states and the slope du of the input.
inline double output_slope(const StateSpace& system, double du, const double* dx) {
  double dy = system.d * du;
  for (std::size_t i = 0; i < system.c.size(); ++i) dy += system.c[i] * dx[i];
  return dy;
}

/// x' into dx.
inline void derivative(const StateSpace& system, double u, const double* x, double* dx) {
  const std::size_t n = system.order();
  const double* row = system.a.data();
  for (std::size_t i = 0; i < n; ++i, row += n) {
    double sum = system.b[i] * u;
    if (!system.constant.empty()) sum += system.constant[i];
    for (std::size_t j = 0; j < n; ++j) sum += row[j] * x[j];
    dx[i] = sum;
  }
}

/// Largest row sum of |A|, a bound on the fastest rate (rad/s); 0 without states.
inline double max_row_sum(const StateSpace& system) {
  const std::size_t n = system.order();
  double most = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    double row = 0.0;
    for (std::size_t j = 0; j < n; ++j) row += std::abs(system.a[i * n + j]);
    most = std::max(most, row);
  }
  return most;
}

/// c (s I - A)^-1 b + d; constants count for nothing.
Complex response(const StateSpace& system, Complex s);
/// The state at rest under u, -A^-1 (b u + constant), into x. A must have an inverse.
void equilibrium(const StateSpace& system, double u, double* x);

/// y = gain u + offset.
StateSpace gain_system(double gain, double offset = 0.0);
/// One section; real poles become two first-order systems in series, a conjugate pair one of order 2 whose
/// second state is the first one's slope over the natural frequency.
StateSpace state_space(const Section& section);
StateSpace state_space(const Sections& sections);
/// `first` feeding `second`: states of the first, then of the second.
StateSpace in_series(const StateSpace& first, const StateSpace& second);

}  // namespace bodesmith
