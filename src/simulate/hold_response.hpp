#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lti/state_space.hpp"
#include "simulate/hold_nodes.hpp"

namespace bodesmith::simulate {

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
