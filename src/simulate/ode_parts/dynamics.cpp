// Dynamics, x' = A x + b u + constant + e n(x, u), y = c x + d u + offset; linear ones without n.

#include <algorithm>

#include "lti/state_space.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/lu.hpp"
#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

class DynamicsPart final : public OdePart {
 public:
  /// `bend`: n, null where there is none.
  DynamicsPart(const StateSpace& linear, const chain::OdeKernel* bend)
      : linear_(linear),
        bend_(bend),
        entry_(bend != nullptr ? bend->entry() : std::vector<double>(linear.order())),
        by_x_(linear.order()) {}

  std::size_t order() const override { return linear_.order(); }
  double fastest_rate() const override { return max_row_sum(linear_); }
  bool strictly_proper() const override { return linear_.order() > 0 && linear_.d == 0.0; }

  double start(double /*t*/, double u, bool still, double* x) override {
    if (still && bend_ != nullptr) bend_->equilibrium(u, x);
    if (still && bend_ == nullptr) equilibrium(linear_, u, x);
    return bodesmith::output(linear_, u, x);
  }
  std::optional<double> output(double /*t*/, double u, const double* x) const override {
    return bodesmith::output(linear_, u, x);
  }
  double newton(double gamma, double du, const double* x, double* z) override {
    const std::size_t n = linear_.order();
    double by_u = 0.0;
    if (bend_ != nullptr) {
      std::ranges::fill(by_x_, 0.0);
      by_u = bend_->nonlinear_gradient(x, in_.value, by_x_.data());
    }
    for (std::size_t i = 0; i < n; ++i) z[i] += gamma * (linear_.b[i] + entry_[i] * by_u) * du;
    if (n == 1) {
      z[0] /= 1.0 - gamma * (linear_.a[0] + entry_[0] * by_x_[0]);
    } else if (n > 1) {
      if (bend_ != nullptr || gamma != gamma_) factorise(gamma);
      Eigen::Map<Eigen::VectorXd> states(z, factors_.rows());
      states = factors_.solve(states).eval();
    }
    return output_slope(linear_, du, z);
  }

 private:
  SlopedValue pass(double /*t*/, SlopedValue in, const double* x, double* dx, Walk /*purpose*/) override {
    derivative(linear_, in.value, x, dx);
    if (bend_ != nullptr) {
      const double force = bend_->nonlinear(x, in.value);
      for (std::size_t i = 0; i < entry_.size(); ++i) dx[i] += entry_[i] * force;
    }
    return {bodesmith::output(linear_, in.value, x), output_slope(linear_, in.slope, dx)};
  }
  /// 1 - gamma (A + e dn/dx).
  void factorise(double gamma) {
    const std::size_t n = linear_.order();
    Eigen::MatrixXd m = Eigen::MatrixXd::Identity(eigen_index(n), eigen_index(n));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t c = 0; c < n; ++c)
        m(eigen_index(i), eigen_index(c)) -= gamma * (linear_.a[i * n + c] + entry_[i] * by_x_[c]);
    }
    factors_.compute(m);
    gamma_ = gamma;
  }

  const StateSpace& linear_;
  const chain::OdeKernel* bend_;
  std::vector<double> entry_, by_x_;
  double gamma_ = 0.0;
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

}  // namespace

std::unique_ptr<OdePart> make_dynamics_part(const StateSpace& linear, const chain::OdeKernel* bend) {
  return std::make_unique<DynamicsPart>(linear, bend);
}

}  // namespace bodesmith::simulate
