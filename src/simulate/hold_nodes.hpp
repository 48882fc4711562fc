#pragma once

#include <array>
#include <cstddef>

namespace bodesmith::simulate {

inline constexpr std::size_t kMaxDegree = 4;

/// Between two times a signal is the polynomial of degree p through its values at the p+1 Gauss-Lobatto
/// points of the interval (both ends included), scaled to [0, 1].
struct HoldNodes {
  std::size_t degree = 1;
  std::array<double, kMaxDegree + 1> at{};
  std::array<double, kMaxDegree + 1> scale{};  ///< 1/product of the distances to the other nodes
  /// Row k: coefficient of s^k as a weighted sum of the node values.
  std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1> monomial{};

  std::size_t size() const { return degree + 1; }
  /// Weights of the node values for the value at s.
  void weights(double s, double* out) const;
  double value(const double* nodes, double s) const;
  double slope(const double* nodes, double s) const;  ///< d/ds
};

/// degree 1 to kMaxDegree.
const HoldNodes& hold_nodes(std::size_t degree);

}  // namespace bodesmith::simulate
