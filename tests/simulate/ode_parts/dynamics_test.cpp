#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "chain/registry.hpp"
#include "lti/cascade.hpp"
#include "simulate/grunwald_letnikov.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;

double largest(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

Options with(Engine engine, double tolerance = 1e-9, std::size_t oversample = 1) {
  Options o;
  o.engine = engine;
  o.relative_tolerance = tolerance;
  o.absolute_tolerance = 1e-2 * tolerance;
  o.oversample = oversample;
  o.estimate_error = false;
  return o;
}

TimeRecord steps_of(double height, double step_s, std::size_t n) {
  TimeRecord r;
  r.step_s = step_s;
  r.u.assign(n, height);
  r.u[0] = 0.0;
  return r;
}

// Of straight lines between samples the integral is exact, by every engine.
TEST(Integrator, AddsUpWhatGoesIn) {
  const Chain chain{{make_block("integrator").set("gain_per_s", 3.0)}};
  TimeRecord in;
  in.step_s = 0.5;
  in.u = {0.0, 1.0, 1.0, -2.0, 0.0};
  const std::vector<double> wanted = {0.0, 0.75, 2.25, 1.5, 0.0};
  for (const Engine engine : {Engine::automatic, Engine::exact, Engine::record, Engine::cvode})
    EXPECT_LT(largest(simulate(chain, in, with(engine)).y, wanted), 1e-6) << to_string(engine);
  EXPECT_NEAR(std::abs(*chain.response(RadPerSecond{6.0}) - std::complex<double>(0.0, -0.5)), 0.0, 1e-12);
}

TEST(Opamp, SmallSignalsSeeItsBandwidth) {
  // 10 MHz, gain 10: 1 MHz.
  Chain chain{
      {make_block("opamp").set("gain", 10.0).set("gain_bandwidth_hz", 10e6).set("slew_rate_v_per_s", 20e6)}};
  const auto in = steps_of(1e-4, 1e-8, 200);
  const auto y = simulate(chain, in, with(Engine::record)).y;
  const double w = 2.0 * std::numbers::pi * 1e6;
  const double h = 1e-8;
  for (std::size_t i = 1; i < y.size(); ++i) {
    // Response to the ramp of the first sample interval.
    const double t = 1e-8 * static_cast<double>(i);
    const double wanted = 1e-3 / h * (h - (std::exp(-w * (t - h)) - std::exp(-w * t)) / w);
    EXPECT_NEAR(y[i], wanted, 1e-6 * 1e-3 + 1e-4 * 1e-3 * 0.1);
  }
}

TEST(Opamp, SlewsAndStopsAtTheRails) {
  Chain chain{{make_block("opamp")
                   .set("gain", 1.0)
                   .set("gain_bandwidth_hz", 10e6)
                   .set("slew_rate_v_per_s", 20e6)
                   .set("lower_rail_v", -5.0)
                   .set("upper_rail_v", 5.0)}};
  TimeRecord in = steps_of(4.0, 1e-8, 400);
  for (std::size_t i = 200; i < 400; ++i) in.u[i] = 9.0;
  const auto y = simulate(chain, in, with(Engine::record)).y;
  EXPECT_NEAR((y[12] - y[7]) / 5e-8, 20e6, 0.01 * 20e6);
  EXPECT_NEAR(y[199], 4.0, 1e-3);
  EXPECT_NEAR(y[399], 5.0, 0.02);
  // The rail is a kink, thirty times faster than the stage.
  const auto exact = simulate(chain, in, with(Engine::cvode)).y;
  EXPECT_LT(largest(y, exact), 0.01);
  EXPECT_LT(largest(simulate(chain, in, with(Engine::record, 1e-9, 16)).y, exact), 2e-4);
  Options rest = with(Engine::record);
  rest.start = Start::equilibrium;
  in.u.assign(50, 9.0);
  const auto still = simulate(chain, in, rest).y;
  for (const double v : still) EXPECT_NEAR(v, still[0], 1e-9);
}

TEST(Multiplier, IsItsEquation) {
  Chain chain{{make_block("multiplier")
                   .set("scale_v", 1.05)
                   .set("x_offset_v", 0.01)
                   .set("y_offset_v", -0.02)
                   .set("z_offset_v", 0.003)
                   .set("feedthrough", 0.004)}};
  TimeRecord in;
  in.step_s = 1.0;
  for (int i = -10; i <= 10; ++i) in.u.push_back(0.1 * i);
  const auto y = simulate(chain, in, with(Engine::record)).y;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double u = in.u[i];
    EXPECT_NEAR(y[i], (u + 0.01) * (u - 0.02) / 1.05 + 0.004 * u + 0.003, 1e-15);
  }
}

TEST(Comparator, SwitchesWithHysteresisInBothEngines) {
  Chain chain{{make_block("comparator")
                   .set("threshold_v", 0.2)
                   .set("hysteresis_v", 0.2)
                   .set("low_v", -1.0)
                   .set("high_v", 2.0),
               make_block("lowpass").set("corner_hz", 3.0)}};
  ReferenceSpec spec;
  spec.kind = "sine";
  spec.amplitude = 1.0;
  spec.offset = 0.0;
  spec.frequency = Hertz{2.0};
  spec.duration_s = 2.0;
  spec.step_s = 0.002;
  const auto in = make_reference(spec);
  const auto exact = simulate(chain, in, with(Engine::cvode));
  EXPECT_GE(exact.stats.events, 8u);
  EXPECT_LT(largest(simulate(chain, in, with(Engine::record, 1e-9, 64)).y, exact.y), 2e-3);
  // The lag's answer to the first switch at sin = 0.3, in closed form.
  const double up = std::acos(-0.3) / (4.0 * std::numbers::pi);
  const std::size_t i = 180;  // still high
  const double t = in.time_s(i);
  const double w = 2.0 * std::numbers::pi * 3.0;
  const double at_switch = -1.0 + std::exp(-w * up);
  EXPECT_NEAR(exact.y[i], 2.0 + (at_switch - 2.0) * std::exp(-w * (t - up)), 2e-4);
}

TEST(SwitchedCapacitor, IsItsDifferenceEquationHeld) {
  Chain chain{{make_block("switched_capacitor")
                   .set("clock_hz", 100.0)
                   .set("z_numerator", std::vector<double>{0.2, 0.1})
                   .set("z_denominator", std::vector<double>{1.0, -0.7})}};
  TimeRecord in;
  in.step_s = 0.01;
  for (int i = 0; i < 60; ++i) in.u.push_back(std::sin(0.3 * i));
  const auto y = simulate(chain, in, with(Engine::record)).y;
  double last = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    last = 0.7 * last + 0.2 * in.u[i] + (i > 0 ? 0.1 * in.u[i - 1] : 0.0);
    EXPECT_NEAR(y[i], last, 1e-13);
  }
  EXPECT_LT(largest(y, simulate(chain, in, with(Engine::cvode)).y), 1e-13);
  Options rest = with(Engine::record);
  rest.start = Start::equilibrium;
  in.u.assign(20, 2.0);
  for (const double v : simulate(chain, in, rest).y) EXPECT_NEAR(v, 2.0, 1e-13);
  Block unstable = make_block("switched_capacitor")
                       .set("clock_hz", 100.0)
                       .set("z_numerator", std::vector<double>{1.0})
                       .set("z_denominator", std::vector<double>{1.0, -1.2});
  EXPECT_TRUE(unstable.validate().has_value());
}

TEST(SwitchedCapacitor, CarriesKTOverCNoise) {
  Chain chain{{make_block("switched_capacitor")
                   .set("clock_hz", 1000.0)
                   .set("z_numerator", std::vector<double>{1.0})
                   .set("z_denominator", std::vector<double>{1.0})
                   .set("noise_capacitor_f", 1e-12)}};
  TimeRecord in;
  in.step_s = 1e-3;
  in.u.assign(40000, 0.0);
  const auto y = simulate(chain, in, with(Engine::record)).y;
  double sum = 0.0;
  for (const double v : y) sum += v * v;
  EXPECT_NEAR(std::sqrt(sum / 40000.0), std::sqrt(2.0 * 1.380649e-23 * 300.0 / 1e-12), 0.02 * 9.1e-5);
}

TEST(Noise, HasItsDensityAndIsTheSameForEveryEngine) {
  Block noise = make_block("noise").set("density_per_rthz", 1e-3).set("bandwidth_hz", 50000.0);
  Chain chain{{noise}};
  TimeRecord in;
  in.step_s = 1e-4;
  in.u.assign(1 << 14, 0.0);
  const auto y = simulate(chain, in, with(Engine::record)).y;
  EXPECT_EQ(largest(y, simulate(chain, in, with(Engine::record, 1e-9, 3)).y), 0.0);
  // Averages over 10 ms see the white density: variance S/2 / T.
  std::vector<double> means;
  for (std::size_t i = 0; i + 100 <= in.size(); i += 100) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 100; ++k) sum += y[i + k];
    means.push_back(sum / 100.0);
  }
  double variance = 0.0;
  for (const double m : means) variance += m * m;
  variance /= static_cast<double>(means.size());
  // Sampled at 10 kHz, on its own grid, all of its power sigma^2 = density^2 bandwidth aliases below 5 kHz.
  EXPECT_NEAR(variance, 1e-6 * 50000.0 / 100.0, 0.3 * 5e-4);
  noise.set("seed", 2.0);
  EXPECT_GT(largest(y, simulate(Chain{{noise}}, in, with(Engine::record)).y), 0.01);
}

TEST(Noise, OneOverFRisesByThreeDecibelAnOctaveDownwards) {
  const Chain chain{{make_block("noise")
                         .set("density_per_rthz", 1e-3)
                         .set("bandwidth_hz", 200.0)
                         .set("corner_hz", 1000.0)
                         .set("lowest_hz", 0.05)}};
  TimeRecord in;
  in.step_s = 1e-3;
  in.u.assign(1 << 17, 0.0);
  const auto y = simulate(chain, in, with(Engine::record)).y;
  // Power of one-octave bands by Haar differences: equal from octave to octave for 1/f.
  std::vector<double> level = y;
  std::vector<double> band;
  for (int octave = 0; octave < 9; ++octave) {
    double sum = 0.0;
    std::vector<double> next;
    for (std::size_t i = 0; i + 1 < level.size(); i += 2) {
      sum += std::pow(0.5 * (level[i + 1] - level[i]), 2);
      next.push_back(0.5 * (level[i] + level[i + 1]));
    }
    band.push_back(sum / static_cast<double>(next.size()));
    level = next;
  }
  for (int k = 4; k < 8; ++k)
    EXPECT_NEAR(band[static_cast<std::size_t>(k)] / band[static_cast<std::size_t>(k - 1)], 1.0, 0.35) << k;
}

TEST(GrunwaldLetnikov, ConvergesToTheApproximationAtSecondOrder) {
  const FractionalLeadLag term{0.05, 0.1, 0.6};
  const Chain chain{{make_block("fractional_lead_lag").set("lambda_s", 0.05).set("x", 0.1).set("beta", 0.6)}};
  double last = 0.0;
  for (const int n : {400, 800, 1600}) {
    TimeRecord in;
    in.step_s = 1.0 / n;
    for (int i = 0; i <= n; ++i) in.u.push_back(std::sin(2.0 * std::numbers::pi * 2.0 * i / n));
    const auto wanted = simulate(chain, in, with(Engine::record)).y;
    const double got = largest(grunwald_letnikov(term, in.u, in.step_s).y, wanted);
    if (last > 0.0) {
      EXPECT_LT(got, last / 3.0);
    }
    last = got;
    EXPECT_LT(got, 40.0 / (static_cast<double>(n) * n) * 10.0);
  }
  EXPECT_LT(last, 5e-4);
}

TEST(GrunwaldLetnikov, TheEngineIsTheSumsOverAllThePast) {
  const FractionalLeadLag term{0.05, 0.1, 0.6};
  const Chain chain{{make_block("fractional_lead_lag").set("lambda_s", 0.05).set("x", 0.1).set("beta", 0.6),
                     make_block("gain").set("gain", 2.0).set("offset", 0.25)}};
  TimeRecord in;
  in.step_s = 2e-3;
  for (int i = 0; i <= 500; ++i) in.u.push_back(std::sin(0.03 * i) + 0.4);
  auto options = with(Engine::grunwald_letnikov);
  options.estimate_error = true;
  const Result result = simulate(chain, in, options);
  const auto sums = grunwald_letnikov(term, in.u, in.step_s, 0.0, false).y;
  for (std::size_t i = 0; i < sums.size(); ++i) EXPECT_NEAR(result.y[i], 2.0 * sums[i] + 0.25, 1e-8) << i;
  // Its own error estimate covers what the better engine says, and half the step halves it.
  const auto better = simulate(chain, in, with(Engine::record)).y;
  EXPECT_LT(largest(result.y, better), 1.3 * *result.error_estimate);
  options.oversample = 2;
  EXPECT_NEAR(largest(simulate(chain, in, options).y, better) / largest(result.y, better), 0.5, 0.1);
  // From rest under the first input nothing happens until it moves.
  in.u.assign(100, 0.4);
  options.start = Start::equilibrium;
  for (const double y : simulate(chain, in, options).y) EXPECT_NEAR(y, 2.0 * 0.4 + 0.25, 1e-9);
  const Chain bent{{make_block("polynomial").set("coefficients", {0.0, 1.0, 1.0})}};
  EXPECT_THROW(simulate(bent, in, with(Engine::grunwald_letnikov)), InputError);
}

TEST(GrunwaldLetnikov, ShortMemoryStaysWithinItsBound) {
  const FractionalLeadLag term{0.05, 0.1, 0.6};
  std::vector<double> u;
  for (int i = 0; i <= 2000; ++i) u.push_back(std::sin(0.02 * i) + 0.5);
  const auto whole = grunwald_letnikov(term, u, 1e-3, 0.0, false);
  EXPECT_EQ(whole.memory_bound, 0.0);
  const auto brief = grunwald_letnikov(term, u, 1e-3, 0.1, false);
  EXPECT_GT(brief.memory_bound, 0.0);
  EXPECT_LE(largest(whole.y, brief.y), brief.memory_bound);
}

TEST(References, HaveTheirShape) {
  ReferenceSpec spec;
  spec.frequency = Hertz{10.0};
  spec.duration_s = 0.2;
  spec.step_s = 1e-3;
  auto r = make_reference(spec);
  ASSERT_EQ(r.size(), 201u);
  EXPECT_EQ(r.u[0], 0.0);
  EXPECT_EQ(r.u[50], 1.0);
  EXPECT_NEAR(r.u[25], 0.5, 1e-15);
  EXPECT_EQ(r.u[100], 0.0);
  spec.kind = "sine";
  r = make_reference(spec);
  EXPECT_NEAR(r.u[50], 1.0, 1e-15);
  EXPECT_NEAR(r.u[25], 0.5, 1e-15);
  spec.kind = "stair";
  spec.steps = 5;
  r = make_reference(spec);
  EXPECT_NEAR(r.u[10], 0.2, 1e-12);
  EXPECT_NEAR(r.u[19], 0.2, 1e-12);
  EXPECT_NEAR(r.u[20], 0.4, 1e-12);
  EXPECT_NEAR(r.u[50], 1.0, 1e-12);
  spec.kind = "complex";
  r = make_reference(spec);
  EXPECT_EQ(r.u[0], 0.415);
  EXPECT_NEAR(r.u[100],
              0.415 + 0.23 * (std::sin(0.2 * std::numbers::pi) + 0.3 * std::sin(0.1 * std::numbers::pi) +
                              0.5 * std::sin(0.02 * std::numbers::pi)),
              1e-14);
  spec.kind = "multisine";
  spec.last = Hertz{90.0};
  spec.duration_s = 0.1;
  r = make_reference(spec);
  // Odd lines only: half a period later the sign is turned.
  for (std::size_t i = 0; i < 50; ++i) EXPECT_NEAR(r.u[i] - 0.5, -(r.u[i + 50] - 0.5), 1e-12);
  EXPECT_LE(*std::max_element(r.u.begin(), r.u.end()), 1.0 + 1e-12);
  spec.kind = "chirp";
  spec.duration_s = 1.0;
  spec.step_s = 1e-5;
  r = make_reference(spec);
  int turns = 0;
  for (std::size_t i = 1; i < r.size(); ++i) turns += (r.u[i - 1] < 0.5) != (r.u[i] < 0.5);
  EXPECT_NEAR(turns / 2.0, (90.0 - 10.0) / std::log(9.0), 1.0);
  // Three periods of 3 Hz are a hundred samples, a period is none: the same values hundreds of them later, steps and turns too.
  spec.frequency = Hertz{3.0};
  spec.step_s = 0.01;
  spec.duration_s = 200.0;
  for (const char* kind : {"triangle", "sine", "stair"}) {
    spec.kind = kind;
    r = make_reference(spec);
    for (std::size_t i = 0; i + 100 < r.size(); ++i)
      ASSERT_NEAR(r.u[i + 100], r.u[i], 1e-10) << kind << " " << i;
    EXPECT_EQ(*std::max_element(r.u.begin(), r.u.end()), 1.0) << kind;
  }
  spec.kind = "wave";
  EXPECT_THROW(make_reference(spec), InputError);
  spec.kind = "sine";
  spec.step_s = 1.0;
  EXPECT_THROW(make_reference(spec), InputError);
}

}  // namespace
}  // namespace bodesmith::simulate
