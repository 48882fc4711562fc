// Engines that share no code agree on every kind of block.
#include <gtest/gtest.h>

#include <cmath>

#include "chain/registry.hpp"
#include "simulate/records.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;

TEST(Engines, AgreeOnALinearChainTo1e9) {
  Chain chain{
      {make_block("pole_zero").set("gain", 1.2).set("zero_hz", 3.0).set("pole_hz", 17.0),
       make_block("resonator").set("gain", 0.8).set("natural_frequency_hz", 40.0).set("damping_ratio", 0.05),
       make_block("creep")
           .set("gains", std::vector<double>{0.1, 0.05})
           .set("time_constants_s", std::vector<double>{0.3, 2.0}),
       make_block("parallel_modes")
           .set("gains", std::vector<double>{0.2, -0.1})
           .set("natural_frequencies_hz", std::vector<double>{12.0, 55.0})
           .set("damping_ratios", std::vector<double>{0.05, 0.02})
           .set("resonator_hz", 40.0)
           .set("resonator_damping_ratio", 0.05),
       make_block("right_half_plane_zero").set("right_zero_hz", 60.0).set("pole_hz", 90.0),
       make_block("gain").set("gain", -3.0).set("offset", 0.25)}};
  const auto in = record_of(401, 0.0025, two_sines);
  for (const auto start : {Start::zero, Start::equilibrium}) {
    EXPECT_LT(max_difference(simulate(chain, in, by_record(1, start)).y,
                             simulate(chain, in, cvode(1e-12, start)).y),
              1e-9);
  }
}

TEST(Engines, AgreeOnCurveThenDynamicsTo1e9) {
  Chain chain{{make_block("lowpass").set("corner_hz", 30.0),
               make_block("polynomial").set("coefficients", std::vector<double>{0.1, 1.0, -0.3, 0.2}),
               make_block("resonator").set("natural_frequency_hz", 25.0).set("damping_ratio", 0.2)}};
  const auto in = record_of(401, 0.0025, two_sines);
  const auto exact = simulate(chain, in, cvode(1e-12)).y;
  EXPECT_LT(max_difference(simulate(chain, in, by_record(4)).y, exact), 1e-9);
  // Order of the hold: halving the step at degree 3 gains at least 2^3.
  const double coarse = max_difference(simulate(chain, in, by_record(1)).y, exact);
  const double fine = max_difference(simulate(chain, in, by_record(2)).y, exact);
  EXPECT_LT(fine, coarse / 8.0);
}

TEST(Engines, AgreeOnADuffingResonatorTo1e9) {
  Chain chain{{make_block("resonator")
                   .set("gain", 0.9)
                   .set("natural_frequency_hz", 12.0)
                   .set("damping_ratio", 0.04)
                   .set("cubic", 2.5)
                   .set("quadratic", -0.4)}};
  const auto in = record_of(801, 0.00125, two_sines);
  const auto exact = simulate(chain, in, cvode(1e-12)).y;
  EXPECT_LT(max_difference(simulate(chain, in, by_record(2)).y, exact), 1e-9);
  const auto still = simulate(chain, in, by_record(2, Start::equilibrium)).y;
  EXPECT_LT(max_difference(still, simulate(chain, in, cvode(1e-12, Start::equilibrium)).y), 1e-9);
  const double y0 = still[0];
  EXPECT_NEAR(y0 - 0.4 * y0 * y0 + 2.5 * y0 * y0 * y0, 0.9 * in.u[0], 1e-12);
}

// The order of a hold grows with its degree: whatever it is, finer holds come to the same.
TEST(Engines, AgreeOnASlewingOpampBeforeASpring) {
  Chain chain{
      {make_block("opamp").set("gain", 2.0).set("gain_bandwidth_hz", 300.0).set("slew_rate_v_per_s", 60.0),
       make_block("resonator")
           .set("natural_frequency_hz", 25.0)
           .set("damping_ratio", 0.2)
           .set("cubic", 0.5)}};
  const auto in = record_of(201, 0.00125, two_sines);
  const auto exact = simulate(chain, in, cvode(1e-12)).y;
  EXPECT_LT(max_difference(simulate(chain, in, by_record(16)).y, exact), 1e-7);
}

TEST(Engines, AgreeOnDrag) {
  // |y'| y' is only once differentiable: the hold's order falls where y' changes sign.
  Chain chain{{make_block("resonator")
                   .set("natural_frequency_hz", 12.0)
                   .set("damping_ratio", 0.02)
                   .set("drag", 0.01)}};
  const auto in = record_of(801, 0.00125, two_sines);
  EXPECT_LT(max_difference(simulate(chain, in, by_record(8)).y, simulate(chain, in, cvode(1e-11)).y), 1e-8);
}

TEST(Engines, AgreeOnKinks) {
  // Second order in the step where a kink falls inside it.
  const auto in = record_of(401, 0.0025, two_sines);
  const Block lag = make_block("lowpass").set("corner_hz", 20.0);
  const Block after = make_block("lowpass").set("corner_hz", 40.0);
  for (const Block& kink :
       {make_block("saturation").set("lower", -0.3).set("upper", 0.4),
        make_block("dead_zone").set("width", 0.2), make_block("backlash").set("width", 0.15),
        make_block("slew_limit").set("rate_per_s", 8.0)}) {
    Chain chain{{lag, kink, after}};
    for (const auto start : {Start::zero, Start::equilibrium}) {
      const auto exact = simulate(chain, in, cvode(1e-11, start));
      EXPECT_LT(max_difference(simulate(chain, in, by_record(64, start)).y, exact.y), 2e-7)
          << kink.type_name();
      EXPECT_GT(exact.stats.events, 3u) << kink.type_name();
    }
  }
}

TEST(Engines, SlewLimitOfATriangleIsExact) {
  // Slower than the triangle: straight lines of the limit's slope, turning where they meet it.
  Chain chain{{make_block("slew_limit").set("rate_per_s", 3.0)}};
  const auto in = record_of(1001, 0.001, triangle);
  EXPECT_LT(max_difference(simulate(chain, in, by_record()).y, simulate(chain, in, cvode()).y), 1e-10);
  const auto y = simulate(chain, in, by_record()).y;
  EXPECT_NEAR(y[100], 0.3, 1e-14);  // climbing behind
  // u = 2 - 8t meets 3t at t = 2/11.
  EXPECT_NEAR(y[181], 3.0 * 0.181, 1e-14);
  EXPECT_NEAR(y[200], 3.0 * 2.0 / 11.0 - 3.0 * (0.2 - 2.0 / 11.0), 1e-13);
}

TEST(Engines, PolynomialHysteresisTakesTheBranchOfTheSlope) {
  Chain chain{{make_block("polynomial_hysteresis")
                   .set("ascending", std::vector<double>{0.3546, -0.6433, 0.2887})
                   .set("descending", std::vector<double>{-0.2398, 0.0838, 0.156})}};
  const auto in = record_of(1001, 0.001, triangle);
  const auto y = simulate(chain, in, by_record()).y;
  for (std::size_t i = 1; i < in.size(); ++i) {
    const double u = in.u[i];
    const double d = u > in.u[i - 1] ? 0.3546 * u - 0.6433 * u * u + 0.2887 * u * u * u
                                     : -0.2398 * u + 0.0838 * u * u + 0.156 * u * u * u;
    EXPECT_NEAR(y[i], u + d, 1e-14);
  }
  EXPECT_LT(max_difference(y, simulate(chain, in, cvode()).y), 1e-11);
}

// At rest a stage with branches shows the rising one; where the record begins with a fall it jumps to the other at once, and memory
// behind it has seen that jump.
TEST(Engines, MemoryBehindBranchesSeesTheFirstFall) {
  const Chain chain{{make_block("polynomial_hysteresis")
                         .set("ascending", std::vector<double>{0.3, -0.5, 0.2})
                         .set("descending", std::vector<double>{-0.2, 0.1, 0.15}),
                     make_block("prandtl_ishlinskii")
                         .set("r", std::vector<double>{0.0, 0.05, 0.2})
                         .set("w", std::vector<double>{0.6, 0.3, 0.2})}};
  const auto in = record_of(201, 0.005, [](double t) { return 0.8 * std::cos(5.0 * t); });
  const auto by = [&](const auto& options) { return simulate(chain, in, options).y; };
  const auto y = by(by_record(1, Start::equilibrium));
  EXPECT_LT(max_difference(y, by(cvode(1e-11, Start::equilibrium))), 1e-9);
  // The plays rest under the rising branch, and the jump down by .04 is shorter than 2 r of all but the first.
  const double rising = 0.8 + 0.3 * 0.8 - 0.5 * 0.64 + 0.2 * 0.512,
               falling = 0.8 - 0.2 * 0.8 + 0.1 * 0.64 + 0.15 * 0.512;
  EXPECT_NEAR(y[0], 0.6 * falling + 0.3 * (rising - 0.05) + 0.2 * (rising - 0.2), 1e-12);
}

TEST(Engines, BranchesAfterAFallingCurveAreThoseOfItsOutput) {
  // 1 - u + .2 u^2 falls while u rises, and its slope is -1 to -.6.
  const Chain chain{{make_block("polynomial").set("coefficients", std::vector<double>{1.0, -1.0, 0.2}),
                     make_block("sine_hysteresis").set("A_ascending", 0.1).set("A_descending", -0.08),
                     make_block("slew_limit").set("rate_per_s", 6.0)}};
  const auto in = record_of(501, 0.002, triangle);
  const auto at_slope = simulate(Chain{{chain.blocks[0], chain.blocks[1]}}, in, cvode()).y;
  for (std::size_t i = 1; i < in.size(); ++i) {
    if (in.u[i] == in.u[i - 1]) continue;  // the turn lies between, and shows a sample later
    const double v = 1.0 - in.u[i] + 0.2 * in.u[i] * in.u[i];
    EXPECT_NEAR(at_slope[i], v + (in.u[i] > in.u[i - 1] ? -0.08 : 0.1) * std::sin(kPi * v), 1e-11) << i;
  }
  // A slew limit follows as long as the slopes on the way stay below it: magnitudes count too.
  EXPECT_LT(max_difference(simulate(chain, in, cvode()).y, simulate(chain, in, by_record(64)).y), 2e-3);
}

TEST(Engines, SineHysteresisTakesTheBranchOfTheSlopeLate) {
  for (const double delay_s : {0.0, 0.0073}) {
    const Chain chain{{make_block("sine_hysteresis")
                           .set("A_ascending", 0.1)
                           .set("A_descending", -0.08)
                           .set("switch_delay_s", delay_s)}};
    const auto in = record_of(1001, 0.001, triangle);
    const auto y = simulate(chain, in, by_record()).y;
    const auto late = static_cast<std::size_t>(delay_s * 1000.0);
    for (std::size_t i = late + 1; i < in.size(); ++i) {
      const bool rising = in.u[i - late] > in.u[i - late - 1];
      EXPECT_NEAR(y[i], in.u[i] + (rising ? 0.1 : -0.08) * std::sin(kPi * in.u[i]), 1e-14) << i;
    }
    EXPECT_LT(max_difference(y, simulate(chain, in, cvode()).y), 1e-11);
  }
}

TEST(Engines, PolynomialHysteresisBehindALagThenDynamics) {
  Chain chain{{make_block("lowpass").set("corner_hz", 15.0),
               make_block("polynomial_hysteresis")
                   .set("ascending", std::vector<double>{0.3546, -0.6433, 0.2887})
                   .set("descending", std::vector<double>{-0.2398, 0.0838, 0.156}),
               make_block("lowpass").set("corner_hz", 60.0)}};
  const auto in = record_of(501, 0.002, triangle);
  const auto exact = simulate(chain, in, cvode(1e-11));
  EXPECT_GE(exact.stats.events, 6u);
  // Jumps inside a hold: first order in the step, seen through the lag.
  EXPECT_LT(max_difference(simulate(chain, in, by_record(1)).y, exact.y), 1e-2);
  EXPECT_LT(max_difference(simulate(chain, in, by_record(32)).y, exact.y), 3e-4);
}

TEST(Engines, HumAndDriftAreInTheTimeOfTheRecord) {
  Chain chain{{make_block("hum").set("amplitude", 0.3).set("frequency_hz", 50.0).set("phase_deg", 30.0),
               make_block("drift").set("rate_per_s", 0.7)}};
  const auto in = record_of(101, 0.001, one, 4.2);
  const auto y = simulate(chain, in, by_record()).y;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double t = in.time_s(i);
    EXPECT_NEAR(y[i], 1.0 + 0.3 * std::sin(2.0 * kPi * 50.0 * t + kPi / 6.0) + 0.7 * t, 1e-12);
  }
  chain.blocks.push_back(make_block("lowpass").set("corner_hz", 80.0));
  EXPECT_LT(max_difference(simulate(chain, in, by_record(8)).y, simulate(chain, in, cvode(1e-12)).y), 1e-9);
}

/// In front of it a curve, and behind it a gain and another, which act value by value.
TEST(Engines, AMemoryThatKnowsTheRateIsSteppedEightTimesASample) {
  const auto memory = make_block("fractional_dynamic")
                          .set("K_M", 1e6)
                          .set("xi", 0.1)
                          .set("omega_n", 1e3)
                          .set("tau", 1e-3)
                          .set("eta", 0.5)
                          .set("lambda", 0.7)
                          .set("K_p", 1.0)
                          .set("Theta", 0.1)
                          .set("chi", 0.2);
  const Chain chain{{make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.2}), memory,
                     make_block("gain").set("gain", -2.0).set("offset", 0.3),
                     make_block("saturation").set("lower", -0.4).set("upper", 0.5)}};
  const auto in = record_of(101, 0.005, two_sines);
  auto kernel = memory.kernel();
  auto& operation = *std::get<std::unique_ptr<chain::MemoryKernel>>(kernel);
  const auto curved = [](double u) { return u + 0.2 * u * u; };
  std::vector<double> wanted = {operation.reset(curved(in.u[0]), false)};
  for (std::size_t i = 1; i < in.size(); ++i) {
    double y = 0.0;
    for (int part = 1; part <= 8; ++part)
      y = operation.step(curved(in.u[i - 1] + (in.u[i] - in.u[i - 1]) * part / 8.0), in.step_s / 8.0);
    wanted.push_back(y);
  }
  for (double& y : wanted) y = std::clamp(-2.0 * y + 0.3, -0.4, 0.5);
  // Steps of the ODE end pieces in between: shorter lines there. One line a sample is 5e-4 off.
  EXPECT_LT(max_difference(simulate(chain, in, cvode()).y, wanted), 2e-5);
  EXPECT_LT(max_difference(simulate(chain, in, by_record(8)).y, wanted), 1e-4);
}

TEST(Engines, SampleAndHoldOnItsOwnClock) {
  for (const bool half : {false, true}) {
    Chain chain{{make_block("sample_hold").set("clock_hz", 130.0).set("half_cycle", half ? 1.0 : 0.0)}};
    const auto in = record_of(401, 0.001, two_sines);
    const auto y = simulate(chain, in, by_record()).y;
    const auto straight = [&](double t) {  // the record between samples
      const auto k = std::min<std::size_t>(static_cast<std::size_t>(t / 0.001), 399);
      return in.u[k] + (in.u[k + 1] - in.u[k]) * (t - 0.001 * static_cast<double>(k)) / 0.001;
    };
    for (std::size_t i = 0; i < in.size(); ++i) {
      const double shown = std::floor((in.time_s(i) - (half ? 0.5 / 130.0 : 0.0)) * 130.0 + 1e-9);
      EXPECT_NEAR(y[i], shown < 0.0 ? 0.0 : straight(shown / 130.0), 1e-12) << i << half;
    }
    EXPECT_LT(max_difference(y, simulate(chain, in, cvode()).y), 1e-12);
    // What has no states acts on each value that is held.
    chain.blocks.push_back(make_block("gain").set("gain", 2.0).set("offset", 0.3));
    chain.blocks.push_back(make_block("saturation").set("lower", -0.5).set("upper", 1.5));
    const auto scaled = simulate(chain, in, by_record()).y;
    for (std::size_t i = 0; i < in.size(); ++i)
      EXPECT_NEAR(scaled[i], std::clamp(2.0 * y[i] + 0.3, -0.5, 1.5), 1e-14);
    chain.blocks = {chain.blocks.front()};
    // Behind it a lag sees the true steps, not their samples.
    chain.blocks.push_back(make_block("lowpass").set("corner_hz", 60.0));
    EXPECT_LT(max_difference(simulate(chain, in, by_record(2)).y, simulate(chain, in, cvode(1e-12)).y), 1e-5);
    EXPECT_LT(max_difference(simulate(chain, in, by_record(8)).y, simulate(chain, in, cvode(1e-12)).y), 1e-7);
    // What goes straight through a section shows the steps where they are.
    chain.blocks.back() = make_block("pole_zero").set("zero_hz", 20.0).set("pole_hz", 60.0);
    EXPECT_LT(max_difference(simulate(chain, in, by_record(2)).y, simulate(chain, in, cvode(1e-12)).y), 3e-5);
    chain.blocks.push_back(make_block("gain").set("gain", 2.0));
    EXPECT_LT(max_difference(simulate(chain, in, by_record(2)).y, simulate(chain, in, cvode(1e-12)).y), 6e-5);
    // Memory sees steps and no turn beside them.
    chain.blocks = {chain.blocks.front(), make_block("backlash").set("width", 0.1), chain.blocks.back()};
    EXPECT_LT(max_difference(simulate(chain, in, by_record(1)).y, simulate(chain, in, cvode()).y), 1e-9);
  }
}

TEST(Engines, EveryHeldStepInFrontOfBranchesIsAMove) {
  Chain chain{{make_block("sample_hold").set("clock_hz", 37.0),
               make_block("polynomial_hysteresis")
                   .set("ascending", std::vector<double>{0.4, -0.4, 0.0})
                   .set("descending", std::vector<double>{-0.3, 0.3, 0.0})}};
  const auto in = record_of(401, 0.005, [](double t) { return 0.5 - 0.4 * std::cos(8.2 * t); });
  constexpr double kCorner = 2.0 * kPi * 30.0;
  const auto straight = [&](double t) {
    const auto k = std::min<std::size_t>(static_cast<std::size_t>(t / 0.005 + 1e-9), 399);
    return in.u[k] + (in.u[k + 1] - in.u[k]) * (t / 0.005 - static_cast<double>(k));
  };
  // Edge by edge, and exponentials between them.
  std::vector<double> shown, low;
  double now = 0.0, u = -1.0, drive = 0.0, state = 0.0;
  for (std::size_t i = 0, edge = 0; i < in.size(); ++i) {
    const auto go_to = [&](double t) {
      state = drive + (state - drive) * std::exp(-kCorner * (t - now));
      now = t;
    };
    for (; static_cast<double>(edge) / 37.0 <= in.time_s(i) + 1e-12; ++edge) {
      go_to(static_cast<double>(edge) / 37.0);
      const double next = straight(now);
      drive = next + (next > u ? 0.4 : -0.3) * next * (1.0 - next);
      u = next;
    }
    go_to(in.time_s(i));
    shown.push_back(drive);
    low.push_back(state);
  }
  EXPECT_LT(max_difference(simulate(chain, in, by_record(1)).y, shown), 1e-12);
  EXPECT_LT(max_difference(simulate(chain, in, cvode(1e-12)).y, shown), 1e-11);
  chain.blocks.push_back(make_block("lowpass").set("corner_hz", 30.0));
  EXPECT_LT(max_difference(simulate(chain, in, by_record(1)).y, low), 1e-5);
  EXPECT_LT(max_difference(simulate(chain, in, by_record(4)).y, low), 1e-8);
  EXPECT_LT(max_difference(simulate(chain, in, cvode(1e-12)).y, low), 1e-10);
}

TEST(Engines, AClockedSectionAtRestRestsAtItsOwnGain) {
  const Chain chain{{make_block("switched_capacitor")
                         .set("clock_hz", 130.0)
                         .set("z_numerator", std::vector<double>{2.0})
                         .set("z_denominator", std::vector<double>{1.0}),
                     make_block("lowpass").set("corner_hz", 3.0)}};
  const auto in = record_of(101, 0.005, one);
  for (const auto& options : {by_record(1, Start::equilibrium), cvode(1e-12, Start::equilibrium)}) {
    for (const double y : simulate(chain, in, options).y) EXPECT_NEAR(y, 2.0, 1e-11);
  }
}

TEST(Engines, FractionalTermMeetsItsStatedError) {
  Chain chain{{make_block("fractional_lead_lag").set("lambda_s", 0.05).set("x", 0.1).set("beta", 0.6)}};
  const auto in = record_of(401, 0.0025, two_sines);
  const auto got = simulate(chain, in, by_record());
  EXPECT_GT(got.model_error, 0.0);
  EXPECT_LT(got.model_error, 5e-6);
  EXPECT_LT(max_difference(got.y, simulate(chain, in, cvode(1e-11)).y), 1e-8);
}

}  // namespace
}  // namespace bodesmith::simulate
