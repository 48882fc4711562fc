#pragma once

#include <Eigen/LU>

#include "lti/state_space.hpp"

namespace bodesmith::simulate {

/// (I - gamma A)^-1 for one part's dense A = a + entry by_x; more than one state.
class ImplicitStep {
 public:
  /// Only the linear part; nothing to do while gamma stays.
  void prepare(const StateSpace& system, double gamma);
  void prepare(const StateSpace& system, double gamma, const std::vector<double>& entry,
               const std::vector<double>& by_x);
  void solve(double* z) const;

 private:
  double gamma_ = 0.0;
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

}  // namespace bodesmith::simulate
