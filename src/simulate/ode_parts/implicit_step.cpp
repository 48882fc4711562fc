#include "simulate/ode_parts/implicit_step.hpp"

#include "numeric/index.hpp"

namespace bodesmith::simulate {

void ImplicitStep::prepare(const StateSpace& system, double gamma) {
  if (gamma_ == gamma) return;
  const Eigen::Index n = eigen_index(system.order());
  const double* a = system.a.data();
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index c = 0; c < n; ++c) m(i, c) -= gamma * a[i * n + c];
  }
  factors_.compute(m);
  gamma_ = gamma;
}

void ImplicitStep::prepare(const StateSpace& system, double gamma, const std::vector<double>& entry,
                           const std::vector<double>& by_x) {
  const std::size_t n = system.order();
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(eigen_index(n), eigen_index(n));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < n; ++c) {
      m(eigen_index(i), eigen_index(c)) -= gamma * (system.a[i * n + c] + entry[i] * by_x[c]);
    }
  }
  factors_.compute(m);
  gamma_ = gamma;
}

void ImplicitStep::solve(double* z) const {
  Eigen::Map<Eigen::VectorXd> states(z, factors_.rows());
  states = factors_.solve(states).eval();
}

}  // namespace bodesmith::simulate
