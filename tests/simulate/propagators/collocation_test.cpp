#include "simulate/propagators/collocation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "chain/registry.hpp"

namespace bodesmith::simulate {
namespace {

/// A spring that hardens sevenfold over its travel; counts how often its force is asked for.
class CountedSpring final : public chain::OdeKernel {
 public:
  const StateSpace& linear() const override { return spring_->linear(); }
  const std::vector<double>& entry() const override { return spring_->entry(); }
  double nonlinear(const double* x, double u) const override {
    ++forces;
    return spring_->nonlinear(x, u);
  }
  double nonlinear_gradient(const double* x, double u, double* by_x) const override {
    return spring_->nonlinear_gradient(x, u, by_x);
  }
  void equilibrium(double u, double* x) const override { spring_->equilibrium(u, x); }

  mutable int forces = 0;

 private:
  chain::Kernel kernel_ = chain::make_block("resonator")
                              .set("natural_frequency_hz", 1.0)
                              .set("damping_ratio", 0.1)
                              .set("cubic", 2.0)
                              .kernel();
  const chain::OdeKernel* spring_ = std::get<std::unique_ptr<chain::OdeKernel>>(kernel_).get();
};

struct Driven {
  double y = 0.0;            ///< at the end
  double forces_a_node = 0;  ///< evaluations, on the average of all nodes that are solved for
};

/// 2 s under u = 3 sin(4 t).
Driven driven_spring(std::size_t holds) {
  const CountedSpring spring;
  const HoldNodes& nodes = hold_nodes(3);
  CollocationPropagator propagator;
  const double h = 2.0 / static_cast<double>(holds);
  propagator.prepare(spring, h, {});
  std::vector<double> u, y(holds * nodes.size());
  for (std::size_t k = 0; k < holds; ++k)
    for (const double s : nodes.places()) u.push_back(3.0 * std::sin(4.0 * h * (static_cast<double>(k) + s)));
  double x[2] = {0.0, 0.0};
  EXPECT_EQ(propagator.run(spring, u.data(), y.data(), holds, x), CollocationPropagator::Outcome::finished);
  EXPECT_EQ(y.back(), x[0]);
  return {y.back(), spring.forces / static_cast<double>(holds * nodes.degree)};
}

TEST(Collocation, HasOrderSixAndSolvesByNewtonsSlopes) {
  const double right = driven_spring(1600).y;
  const Driven coarse = driven_spring(100), fine = driven_spring(200);
  EXPECT_NEAR(std::log2((coarse.y - right) / (fine.y - right)), 6.0, 0.15);
  // Without the slopes at the nodes 4.2 to 7.4 and 3.9 to 6.
  EXPECT_LT(coarse.forces_a_node, 4.0);
  EXPECT_LT(fine.forces_a_node, 3.4);
}

}  // namespace
}  // namespace bodesmith::simulate
