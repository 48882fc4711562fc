// Each part of an ODE: its share of the implicit step against difference quotients of its own rates, and what
// a whole system makes of them.
#include "simulate/ode_parts/ode_part.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "chain/registry.hpp"
#include "simulate/ode/ode_system.hpp"
#include "simulate/records.hpp"

namespace bodesmith::simulate {
namespace {

using chain::make_block;

/// Blocks of every kind that can stand in an ODE, smooth where they stand.
std::vector<chain::Block> smooth_blocks() {
  return {make_block("gain").set("gain", 1.7),
          make_block("lowpass").set("corner_hz", 3.0),
          make_block("resonator").set("natural_frequency_hz", 2.0).set("damping_ratio", 0.3),
          make_block("resonator")
              .set("natural_frequency_hz", 2.0)
              .set("damping_ratio", 0.3)
              .set("cubic", 0.4)
              .set("drag", 0.2),
          make_block("polynomial").set("coefficients", std::vector<double>{0.1, 1.0, 0.3}),
          make_block("opamp").set("gain", 2.0).set("gain_bandwidth_hz", 3.0).set("slew_rate_v_per_s", 4.0),
          make_block("drift").set("rate_per_s", 0.2)};
}

TEST(OdeParts, TheImplicitStepSolvesWithTheSlopesOfTheRates) {
  // (I - gamma df/dx) z = b for all parts in series, df/dx by central differences.
  std::vector<chain::Kernel> kernels;
  for (const auto& block : smooth_blocks()) kernels.push_back(block.kernel());
  std::vector<chain::Kernel*> pointers;
  for (auto& kernel : kernels) {
    ASSERT_TRUE(can_stand_in_ode(kernel));
    pointers.push_back(&kernel);
  }
  const DenseSignal input = DenseSignal::from_record(record_of(11, 0.1, ramp));
  OdeSystem system(pointers, input);
  system.start(Start::zero, 0.0);
  const std::size_t n = system.state().size();
  ASSERT_EQ(n, 6u);
  std::vector<double> x = {0.3, -0.2, 0.5, 0.1, -0.4, 0.2};
  const std::vector<double> b = {1.0, -2.0, 0.5, 0.7, 0.2, -0.6};
  const double t = 0.35;
  const double gamma = 0.02;
  std::vector<double> z = b;
  system.newton(t, x.data(), gamma, z.data());
  std::vector<double> back = z;
  for (std::size_t j = 0; j < n; ++j) {
    const double h = 1e-6;
    std::vector<double> up(n), down(n);
    const double at = x[j];
    x[j] = at + h;
    system.evaluate(t, x.data(), up.data());
    x[j] = at - h;
    system.evaluate(t, x.data(), down.data());
    x[j] = at;
    for (std::size_t i = 0; i < n; ++i) back[i] -= gamma * (up[i] - down[i]) / (2.0 * h) * z[j];
  }
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(back[i], b[i], 1e-7) << i;
}

TEST(OdeParts, SayWhatTheyAre) {
  const auto part_of = [](const chain::Kernel& kernel) { return make_ode_part(kernel); };
  const chain::Kernel lag = make_block("lowpass").set("corner_hz", 3.0).kernel();
  EXPECT_TRUE(part_of(lag)->strictly_proper());
  double state = 0.3;
  EXPECT_TRUE(part_of(lag)->output(0.0, 1.0, &state).has_value());
  EXPECT_NEAR(part_of(lag)->fastest_rate(), 2.0 * kPi * 3.0, 1e-12);
  const chain::Kernel slew = make_block("slew_limit").set("rate_per_s", 2.0).kernel();
  EXPECT_EQ(part_of(slew)->order(), 1u);
  EXPECT_EQ(part_of(slew)->events(), 1u);
  EXPECT_TRUE(part_of(slew)->needs_slopes());
  EXPECT_FALSE(part_of(slew)->output(0.0, 1.0, &state).has_value());
  const chain::Kernel delay = make_block("delay").set("delay_s", 0.1).kernel();
  EXPECT_FALSE(can_stand_in_ode(delay));
}

}  // namespace
}  // namespace bodesmith::simulate
