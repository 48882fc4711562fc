// x' = A x + b u + constant, y = c x + d u + offset.
#include "simulate/ode_parts/implicit_step.hpp"
#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

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
  double output(double /*t*/, double u, const double* x) const override {
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

std::unique_ptr<OdePart> make_linear_part(const StateSpace& system) {
  return std::make_unique<LinearPart>(system);
}

}  // namespace bodesmith::simulate
