// Smooth nonlinear dynamics, x' = A x + b u + constant + e n(x, u), y = c x + d u + offset.
#include "simulate/ode_parts/implicit_step.hpp"
#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

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
  double output(double /*t*/, double u, const double* x) const override {
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

}  // namespace

std::unique_ptr<OdePart> make_dynamics_part(const chain::OdeKernel& system) {
  return std::make_unique<DynamicsPart>(system);
}

}  // namespace bodesmith::simulate
