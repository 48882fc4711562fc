// The record engine: exact where it says so, its initial states, parameters that change.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "chain/registry.hpp"
#include "simulate/record/record_simulator.hpp"
#include "simulate/records.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;

TEST(RecordEngine, LowpassOfARampAndAStepAreExact) {
  Chain chain{{make_block("lowpass").set("corner_hz", 3.0)}};
  const double tau = 1.0 / (2.0 * kPi * 3.0);
  const auto in = record_of(201, 0.01, ramp);
  const auto got = simulate(chain, in, by_record());
  EXPECT_EQ(got.stats.degree, 1);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double t = in.time_s(i);
    EXPECT_NEAR(got.y[i], t - tau * (1.0 - std::exp(-t / tau)), 1e-14);
  }
  const auto step = simulate(chain, record_of(201, 0.01, one), by_record());
  for (std::size_t i = 0; i < in.size(); ++i)
    EXPECT_NEAR(step.y[i], 1.0 - std::exp(-in.time_s(i) / tau), 1e-14);
}

/// A ramp through n equal lags: t - n tau + tau exp(-t/tau) sum (n - k) (t/tau)^k/k!, k = 0 ... n - 1; no modes, more states than
/// the compiler was told of.
TEST(RecordEngine, ManyEqualLagsOfARampAreExact) {
  for (const int n : {3, 9, 12}) {
    Chain chain;
    for (int i = 0; i < n; ++i) chain.blocks.push_back(make_block("lowpass").set("corner_hz", 10.0));
    const double tau = 1.0 / (2.0 * M_PI * 10.0);
    TimeRecord ramp;
    ramp.step_s = 3e-3;
    for (int i = 0; i < 120; ++i) ramp.u.push_back(ramp.step_s * i);
    Options options;
    options.engine = Engine::record;
    options.start = Start::zero;
    const std::vector<double> y = simulate(chain, ramp, options).y;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double x = ramp.u[i] / tau;
      double sum = 0.0, term = 1.0;
      for (int k = 0; k < n; ++k) {
        sum += (n - k) * term;
        term *= x / (k + 1);
      }
      EXPECT_NEAR(y[i], ramp.u[i] - n * tau + tau * std::exp(-x) * sum, 1e-10) << n << " at " << i;
    }
  }
}

/// Also where the dynamics are so fast that a sample interval is many steps: half the step is half of each of them. An op-amp
/// at its rail has a kink within them.
TEST(RecordEngine, StatesTheErrorOfDynamicsFasterThanTheSamples) {
  const double step_s = 1e-3;
  const auto in = record_of(60, step_s, [](double t) { return 0.5 * std::sin(2.0 * kPi * 50.0 * t); });
  for (const double bandwidth_hz : {190.0, 530.0, 1000.0}) {
    const Chain chain{{make_block("opamp")
                           .set("gain", 4.0)
                           .set("gain_bandwidth_hz", 4.0 * bandwidth_hz)
                           .set("slew_rate_v_per_s", 800.0)
                           .set("lower_rail_v", -0.386)}};
    Options options = by_record();
    options.estimate_error = true;
    const Result got = simulate(chain, in, options);
    const double off = max_difference(got.y, simulate(chain, in, cvode()).y);
    EXPECT_GT(off, 1e-6);
    EXPECT_LT(off, 4.0 * *got.error_estimate) << bandwidth_hz;
  }
}

TEST(RecordEngine, ADelayThatIsNoMultipleOfTheStepIsExactInALinearRun) {
  const double tau = 1.0 / (2.0 * kPi * 3.0);
  const double delay = 0.0337;
  for (const bool delay_first : {true, false}) {
    Chain chain;
    const Block lag = make_block("lowpass").set("corner_hz", 3.0);
    const Block wait = make_block("delay").set("delay_s", delay);
    chain.blocks = delay_first ? std::vector<Block>{wait, lag} : std::vector<Block>{lag, wait};
    const auto in = record_of(101, 0.01, ramp);
    const auto got = simulate(chain, in, by_record());
    for (std::size_t i = 0; i < in.size(); ++i) {
      const double t = std::max(0.0, in.time_s(i) - delay);
      EXPECT_NEAR(got.y[i], t - tau * (1.0 - std::exp(-t / tau)), 1e-14);
    }
    EXPECT_LT(max_difference(got.y, simulate(chain, in, cvode()).y), 1e-9);
  }
}

TEST(RecordEngine, OffsetsBehindADelayActAtOnce) {
  Chain chain{
      {make_block("gain").set("gain", 2.0).set("offset", 0.5), make_block("delay").set("delay_s", 0.025),
       make_block("gain").set("gain", 3.0).set("offset", -1.0), make_block("lowpass").set("corner_hz", 5.0)}};
  const auto in = record_of(101, 0.01, two_sines);
  EXPECT_LT(max_difference(simulate(chain, in, by_record()).y, simulate(chain, in, cvode()).y), 1e-9);
  EXPECT_LT(max_difference(simulate(chain, in, by_record(1, Start::equilibrium)).y,
                           simulate(chain, in, cvode(1e-11, Start::equilibrium)).y),
            1e-9);
}

TEST(RecordEngine, ParametersChangeBetweenRuns) {
  Chain chain{{make_block("gain"), make_block("lowpass").set("corner_hz", 2.0)}};
  RecordSimulator simulator(chain, 0.01);
  const std::vector<double> u(50, 1.0);
  simulator.run(u);
  simulator.chain().blocks[1].set("corner_hz", 7.0);
  EXPECT_NEAR(simulator.run(u)[10], 1.0 - std::exp(-2.0 * kPi * 7.0 * 0.1), 1e-14);
}

TEST(RecordEngine, AStiffStageStaysAccurate) {
  // 65 kHz against steps of 10 ms: the matrix exponential is squared twenty times.
  Chain chain{{make_block("resonator").set("natural_frequency_hz", 65100.0).set("damping_ratio", 0.12)}};
  const auto in = record_of(101, 0.01, ramp);
  const auto y = simulate(chain, in, by_record()).y;
  const double lag = 2.0 * 0.12 / (2.0 * kPi * 65100.0);
  for (std::size_t i = 1; i < in.size(); ++i) EXPECT_NEAR(y[i], in.u[i] - lag, 1e-10);
}

TEST(RecordEngine, SamplesThatLieElsewhereGiveTheSame) {
  Chain chain{{make_block("lowpass").set("corner_hz", 3.0)}};
  const auto in = record_of(50, 0.01, ramp);
  const SampledInput view = in;
  auto options = by_record();
  for (const bool estimate : {false, true}) {
    options.estimate_error = estimate;
    EXPECT_EQ(simulate(chain, view, options).y, simulate(chain, in, options).y);
  }
  EXPECT_THROW(simulate(chain, SampledInput(0.0, 1.0, {}), options), InputError);
}

}  // namespace
}  // namespace bodesmith::simulate
