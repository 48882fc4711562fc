#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lti/state_space.hpp"

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
  std::span<const double> places() const { return {at.data(), size()}; }
  /// Weights of the node values for the value at s.
  void weights(double s, double* out) const;
  double value(const double* nodes, double s) const;
  double slope(const double* nodes, double s) const;  ///< d/ds
};

/// Holds of equal length, one behind the other: a signal is a row of such spans.
struct HoldSpan {
  std::size_t holds = 0;
  double h = 0.0;  ///< s

  bool operator==(const HoldSpan&) const = default;
};

/// Degree 1 or 3 (holds of the record engine), or 4 (pieces of a DenseSignal).
const HoldNodes& hold_nodes(std::size_t degree);

/// x' = A x + sum_q b_q v_q + constant. `a` is row-major, order x order; every other array has `order`
/// values.
struct DrivenSystem {
  std::size_t order = 0;
  const double* a = nullptr;
  std::span<const double* const> inputs;  ///< b_q
  const double* constant = nullptr;       ///< null: zero
};

/// A state space under other inputs than its own b.
inline DrivenSystem driven(const StateSpace& system, std::span<const double* const> inputs) {
  return {system.order(), system.a.data(), inputs,
          system.constant.empty() ? nullptr : system.constant.data()};
}

/// x after the part `s` of a hold of h seconds, each v_q given at the hold's nodes:
///   x(s h) = E x(0) + sum_q G_q v_q + k.
/// Exact (matrix exponential of the system augmented by monomials).
struct HoldResponse {
  std::vector<double> e;               ///< order x order
  std::vector<std::vector<double>> g;  ///< per input: order x (degree+1)
  std::vector<double> k;               ///< order
};

/// Keeps its working space from one solution to the next.
class HoldResponseSolver {
 public:
  void solve(const DrivenSystem& system, double h, const HoldNodes& nodes, double s, HoldResponse& out);

 private:
  std::vector<double> matrix_;
  std::vector<double> work_;
};

}  // namespace bodesmith::simulate
