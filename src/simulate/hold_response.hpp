#pragma once

#include <vector>

#include "lti/state_space.hpp"
#include "simulate/hold_nodes.hpp"

namespace bodesmith::simulate {

/// x after the part `s` of a hold of h seconds, for x' = A x + sum_q b_q v_q(t) + constant with each v_q
/// given at the hold's nodes:  x(s h) = E x(0) + sum_q G_q v_q + k.  Exact (matrix exponential of the system
/// augmented by monomials).
struct HoldResponse {
  int order = 0;
  std::vector<double> e;               ///< order x order
  std::vector<std::vector<double>> g;  ///< per input: order x (degree+1)
  std::vector<double> k;               ///< order
};

class HoldResponseSolver {
 public:
  void solve(const StateSpace& system, const std::vector<const double*>& inputs, double h,
             const HoldNodes& nodes, double s, HoldResponse& out);

 private:
  std::vector<double> matrix_;
  std::vector<double> work_;
};

}  // namespace bodesmith::simulate
