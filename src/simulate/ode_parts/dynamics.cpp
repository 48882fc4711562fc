// Smooth nonlinear dynamics, x' = A x + b u + constant + e n(x, u), y = c x + d u + offset.
// x' = A x + b u + constant, y = c x + d u + offset.

#include "lti/state_space.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/lu.hpp"
#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

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

class DynamicsPart final : public OdePart {
 public:
  explicit DynamicsPart(const chain::OdeKernel& system)
      : system_(system), linear_(system.linear()), by_x_(linear_.order()) {}

  std::size_t order() const override { return linear_.order(); }
  double fastest_rate() const override { return max_row_sum(linear_); }
  bool strictly_proper() const override { return linear_.order() > 0 && linear_.d == 0.0; }

  double start(double /*t*/, double u, bool still, double* x) override {
    if (still) system_.equilibrium(u, x);
    return bodesmith::output(linear_, u, x);
  }
  std::optional<double> output(double /*t*/, double u, const double* x) const override {
    return bodesmith::output(linear_, u, x);
  }
  double newton(double gamma, double du, const double* x, double* z) override {
    const std::size_t n = linear_.order();
    const std::vector<double>& entry = system_.entry();
    by_x_.assign(n, 0.0);
    const double by_u = system_.nonlinear_gradient(x, in_.value, by_x_.data());
    for (std::size_t i = 0; i < n; ++i) z[i] += gamma * (linear_.b[i] + entry[i] * by_u) * du;
    if (n == 1) {
      z[0] /= 1.0 - gamma * (linear_.a[0] + entry[0] * by_x_[0]);
    } else if (n > 1) {
      step_.prepare(linear_, gamma, entry, by_x_);
      step_.solve(z);
    }
    return output_slope(linear_, du, z);
  }

 private:
  SlopedValue pass(double /*t*/, SlopedValue in, const double* x, double* dx, Walk /*purpose*/) override {
    const std::size_t n = linear_.order();
    const std::vector<double>& entry = system_.entry();
    const double force = system_.nonlinear(x, in.value);
    const double* row = linear_.a.data();
    for (std::size_t i = 0; i < n; ++i, row += n) {
      double sum = linear_.b[i] * in.value + entry[i] * force;
      if (!linear_.constant.empty()) sum += linear_.constant[i];
      for (std::size_t j = 0; j < n; ++j) sum += row[j] * x[j];
      dx[i] = sum;
    }
    return {bodesmith::output(linear_, in.value, x), output_slope(linear_, in.slope, dx)};
  }

  const chain::OdeKernel& system_;
  const StateSpace& linear_;
  ImplicitStep step_;
  std::vector<double> by_x_;
};

class LinearPart final : public OdePart {
 public:
  explicit LinearPart(const StateSpace& system) : system_(system) {}

  std::size_t order() const override { return system_.order(); }
  double fastest_rate() const override { return max_row_sum(system_); }
  bool strictly_proper() const override { return system_.order() > 0 && system_.d == 0.0; }

  double start(double /*t*/, double u, bool still, double* x) override {
    if (still) equilibrium(system_, u, x);
    return bodesmith::output(system_, u, x);
  }
  std::optional<double> output(double /*t*/, double u, const double* x) const override {
    return bodesmith::output(system_, u, x);
  }
  double newton(double gamma, double du, const double* /*x*/, double* z) override {
    const std::size_t n = system_.order();
    for (std::size_t i = 0; i < n; ++i) z[i] += gamma * system_.b[i] * du;
    if (n == 1) {
      z[0] /= 1.0 - gamma * system_.a[0];
    } else if (n > 1) {
      step_.prepare(system_, gamma);
      step_.solve(z);
    }
    return output_slope(system_, du, z);
  }

 private:
  SlopedValue pass(double /*t*/, SlopedValue in, const double* x, double* dx, Walk /*purpose*/) override {
    derivative(system_, in.value, x, dx);
    return {bodesmith::output(system_, in.value, x), output_slope(system_, in.slope, dx)};
  }

  const StateSpace& system_;
  ImplicitStep step_;
};

}  // namespace

std::unique_ptr<OdePart> make_dynamics_part(const chain::OdeKernel& system) {
  return std::make_unique<DynamicsPart>(system);
}

std::unique_ptr<OdePart> make_linear_part(const StateSpace& system) {
  return std::make_unique<LinearPart>(system);
}

}  // namespace bodesmith::simulate
