#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "chain/registry.hpp"
#include "simulate/record_simulator.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;
constexpr double kPi = std::numbers::pi;

TimeRecord record_of(std::size_t n, double step, double (*f)(double), double start = 0.0) {
  TimeRecord r;
  r.start_s = start;
  r.step_s = step;
  for (std::size_t i = 0; i < n; ++i) r.u.push_back(f(r.time_s(i)));
  return r;
}

double two_sines(double t) {
  return 0.7 * std::sin(2.0 * kPi * 5.0 * t) + 0.4 * std::sin(2.0 * kPi * 13.0 * t + 1.0);
}
double ramp(double t) {
  return t;
}
double one(double) {
  return 1.0;
}
double triangle(double t) {
  const double p = 4.0 * t - std::floor(4.0 * t);
  return p < 0.5 ? 2.0 * p : 2.0 - 2.0 * p;
}

Options cvode(double tolerance = 1e-11, Start start = Start::zero) {
  Options o;
  o.engine = Engine::cvode;
  o.relative_tolerance = tolerance;
  o.absolute_tolerance = 1e-2 * tolerance;
  o.start = start;
  o.estimate_error = false;
  return o;
}
Options by_record(std::size_t oversample = 1, Start start = Start::zero, std::size_t degree = 0) {
  Options o;
  o.engine = Engine::record;
  o.oversample = oversample;
  o.degree = degree;
  o.start = start;
  o.estimate_error = false;
  return o;
}

double largest(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

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
    EXPECT_LT(largest(got.y, simulate(chain, in, cvode()).y), 1e-9);
  }
}

TEST(RecordEngine, OffsetsBehindADelayActAtOnce) {
  Chain chain{
      {make_block("gain").set("gain", 2.0).set("offset", 0.5), make_block("delay").set("delay_s", 0.025),
       make_block("gain").set("gain", 3.0).set("offset", -1.0), make_block("lowpass").set("corner_hz", 5.0)}};
  const auto in = record_of(101, 0.01, two_sines);
  EXPECT_LT(largest(simulate(chain, in, by_record()).y, simulate(chain, in, cvode()).y), 1e-9);
  EXPECT_LT(largest(simulate(chain, in, by_record(1, Start::equilibrium)).y,
                    simulate(chain, in, cvode(1e-11, Start::equilibrium)).y),
            1e-9);
}

TEST(Engines, AgreeOnALinearChainTo1e9) {
  Chain chain{
      {make_block("pole_zero").set("gain", 1.2).set("zero_hz", 3.0).set("pole_hz", 17.0),
       make_block("resonator").set("gain", 0.8).set("natural_frequency_hz", 40.0).set("damping_ratio", 0.05),
       make_block("creep")
           .set("gains", std::vector<double>{0.1, 0.05})
           .set("time_constants_s", std::vector<double>{0.3, 2.0}),
       make_block("gain").set("gain", -3.0).set("offset", 0.25)}};
  const auto in = record_of(401, 0.0025, two_sines);
  for (const auto start : {Start::zero, Start::equilibrium}) {
    EXPECT_LT(largest(simulate(chain, in, by_record(1, start)).y, simulate(chain, in, cvode(1e-12, start)).y),
              1e-9);
  }
}

TEST(Engines, AgreeOnCurveThenDynamicsTo1e9) {
  Chain chain{{make_block("lowpass").set("corner_hz", 30.0),
               make_block("polynomial").set("coefficients", std::vector<double>{0.1, 1.0, -0.3, 0.2}),
               make_block("resonator").set("natural_frequency_hz", 25.0).set("damping_ratio", 0.2)}};
  const auto in = record_of(401, 0.0025, two_sines);
  const auto exact = simulate(chain, in, cvode(1e-12)).y;
  EXPECT_LT(largest(simulate(chain, in, by_record(4)).y, exact), 1e-9);
  // Order of the hold: halving the step at degree 3 gains at least 2^3.
  const double coarse = largest(simulate(chain, in, by_record(1)).y, exact);
  const double fine = largest(simulate(chain, in, by_record(2)).y, exact);
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
  EXPECT_LT(largest(simulate(chain, in, by_record(2)).y, exact), 1e-9);
  const auto still = simulate(chain, in, by_record(2, Start::equilibrium)).y;
  EXPECT_LT(largest(still, simulate(chain, in, cvode(1e-12, Start::equilibrium)).y), 1e-9);
  const double y0 = still[0];
  EXPECT_NEAR(y0 - 0.4 * y0 * y0 + 2.5 * y0 * y0 * y0, 0.9 * in.u[0], 1e-12);
}

TEST(Engines, AgreeOnDrag) {
  // |y'| y' is only once differentiable: the hold's order falls where y' changes sign.
  Chain chain{{make_block("resonator")
                   .set("natural_frequency_hz", 12.0)
                   .set("damping_ratio", 0.02)
                   .set("drag", 0.01)}};
  const auto in = record_of(801, 0.00125, two_sines);
  EXPECT_LT(largest(simulate(chain, in, by_record(8)).y, simulate(chain, in, cvode(1e-11)).y), 1e-8);
}

TEST(Engines, AutomaticMeetsItsTolerance) {
  Chain chain{{make_block("lowpass").set("corner_hz", 30.0),
               make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, -0.3, 0.2}),
               make_block("resonator").set("natural_frequency_hz", 25.0).set("damping_ratio", 0.2)}};
  const auto in = record_of(401, 0.0025, two_sines);
  Options options;
  const auto got = simulate(chain, in, options);
  ASSERT_TRUE(got.error_estimate.has_value());
  EXPECT_LT(*got.error_estimate, 1e-7);
  EXPECT_LT(largest(got.y, simulate(chain, in, cvode(1e-12)).y), *got.error_estimate + 1e-10);
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
      EXPECT_LT(largest(simulate(chain, in, by_record(64, start)).y, exact.y), 2e-7) << kink.type_name();
      EXPECT_GT(exact.stats.events, 3u) << kink.type_name();
    }
  }
}

TEST(Engines, SlewLimitOfATriangleIsExact) {
  // Slower than the triangle: straight lines of the limit's slope, turning where they meet it.
  Chain chain{{make_block("slew_limit").set("rate_per_s", 3.0)}};
  const auto in = record_of(1001, 0.001, triangle);
  EXPECT_LT(largest(simulate(chain, in, by_record()).y, simulate(chain, in, cvode()).y), 1e-10);
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
  EXPECT_LT(largest(y, simulate(chain, in, cvode()).y), 1e-11);
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
  EXPECT_LT(largest(simulate(chain, in, by_record(1)).y, exact.y), 1e-2);
  EXPECT_LT(largest(simulate(chain, in, by_record(32)).y, exact.y), 3e-4);
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
  EXPECT_LT(largest(simulate(chain, in, by_record(8)).y, simulate(chain, in, cvode(1e-12)).y), 1e-9);
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
    EXPECT_LT(largest(y, simulate(chain, in, cvode()).y), 1e-12);
    // Behind it a lag sees the true steps, not their samples.
    chain.blocks.push_back(make_block("lowpass").set("corner_hz", 60.0));
    EXPECT_LT(largest(simulate(chain, in, by_record(2)).y, simulate(chain, in, cvode(1e-12)).y), 1e-5);
    EXPECT_LT(largest(simulate(chain, in, by_record(8)).y, simulate(chain, in, cvode(1e-12)).y), 1e-7);
  }
}

/// The seed's generator and eight poles under a triangle.
Chain seed_chain() {
  Chain chain{{make_block("polynomial_hysteresis")
                   .set("ascending", std::vector<double>{0.3546, -0.6433, 0.2887})
                   .set("descending", std::vector<double>{-0.2398, 0.0838, 0.156})}};
  const double zeros[] = {48.79, 14.8, 107.6, 63.68, 380.2, 221.6, 400.0, 365.6};
  const double poles[] = {47.49, 13.99, 126.4, 102.2, 214.9, 124.8, 652.1, 589.4};
  for (int i = 0; i < 8; ++i) {
    chain.blocks.push_back(make_block("pole_zero")
                               .set("zero_hz", zeros[i] / (2.0 * kPi))
                               .set("pole_hz", poles[i] / (2.0 * kPi)));
  }
  return chain;
}

TEST(Engines, ExactRecordAndCvodeAgreeOnTheSeedsChainTo1e9) {
  const auto in = record_of(2001, 0.0005, triangle);
  Options exact;
  exact.engine = Engine::exact;
  for (const auto start : {Start::zero, Start::equilibrium}) {
    exact.start = start;
    const auto got = simulate(seed_chain(), in, exact);
    EXPECT_EQ(got.stats.engine, Engine::exact);
    EXPECT_EQ(got.stats.steps, 8u);
    EXPECT_LT(*got.error_estimate, 1e-10);
    EXPECT_LT(largest(got.y, simulate(seed_chain(), in, by_record(1, start)).y), 1e-11);
    EXPECT_LT(largest(got.y, simulate(seed_chain(), in, cvode(1e-12, start)).y), 1e-9);
  }
  Options automatic;
  EXPECT_EQ(simulate(seed_chain(), in, automatic).stats.engine, Engine::exact);
  EXPECT_EQ(simulate(seed_chain(), record_of(201, 0.01, two_sines), automatic).stats.engine, Engine::record);
}

TEST(Engines, ExactWithDelayGainAndDrift) {
  Chain chain{{make_block("gain").set("gain", 2.0).set("offset", -0.3),
               make_block("drift").set("rate_per_s", 0.4),
               make_block("polynomial").set("coefficients", std::vector<double>{0.2, 1.0, 0.0, -0.1}),
               make_block("delay").set("delay_s", 0.01234),
               make_block("resonator").set("natural_frequency_hz", 30.0).set("damping_ratio", 0.1),
               make_block("gain").set("gain", -1.5).set("offset", 0.7)}};
  const auto in = record_of(1001, 0.001, triangle, 0.125);
  Options exact;
  exact.engine = Engine::exact;
  for (const auto start : {Start::zero, Start::equilibrium}) {
    exact.start = start;
    EXPECT_LT(largest(simulate(chain, in, exact).y, simulate(chain, in, cvode(1e-12, start)).y), 1e-9);
  }
  chain.blocks.push_back(make_block("saturation").set("lower", -1.0).set("upper", 1.0));
  EXPECT_THROW(simulate(chain, in, exact), InputError);
}

TEST(Engines, FractionalTermMeetsItsStatedError) {
  Chain chain{{make_block("fractional_lead_lag").set("lambda_s", 0.05).set("x", 0.1).set("beta", 0.6)}};
  const auto in = record_of(401, 0.0025, two_sines);
  const auto got = simulate(chain, in, by_record());
  EXPECT_GT(got.model_error, 0.0);
  EXPECT_LT(got.model_error, 5e-6);
  EXPECT_LT(largest(got.y, simulate(chain, in, cvode(1e-11)).y), 1e-8);
}

TEST(RecordEngine, InitialStatesAreUnknownsOfTheRun) {
  Chain chain{
      {make_block("lowpass").set("corner_hz", 2.0),
       make_block("resonator").set("natural_frequency_hz", 4.0).set("damping_ratio", 0.1).set("cubic", 0.3)}};
  RecordSimulator simulator(chain, 0.01);
  ASSERT_EQ(simulator.initial_states().size(), 3u);
  simulator.initial_states()[0] = 0.5;   // the lag's output
  simulator.initial_states()[1] = -0.2;  // the resonator's
  const std::vector<double> u(50, 0.0);
  const auto y = simulator.run(u);
  EXPECT_NEAR(y[0], -0.2, 1e-15);
  const auto lag = std::vector<double>(simulator.run_until(u, 1).begin(), simulator.run_until(u, 1).end());
  EXPECT_NEAR(lag[10], 0.5 * std::exp(-2.0 * kPi * 2.0 * 0.1), 1e-14);
}

TEST(RecordEngine, InitialStatesBehindADelayAreNotDelayed) {
  Chain chain{{make_block("delay").set("delay_s", 0.1), make_block("lowpass").set("corner_hz", 2.0)}};
  RecordSimulator simulator(chain, 0.01);
  simulator.initial_states()[0] = 1.0;
  const std::vector<double> u(50, 0.0);
  const auto y = simulator.run(u);
  for (std::size_t i = 0; i < u.size(); ++i)
    EXPECT_NEAR(y[i], std::exp(-2.0 * kPi * 2.0 * 0.01 * static_cast<double>(i)), 1e-14);
}

TEST(RecordEngine, ParametersChangeBetweenRuns) {
  Block lag = make_block("lowpass").set("corner_hz", 2.0);
  ASSERT_TRUE(lag.free("corner_hz"));
  Chain chain{{make_block("gain"), lag}};
  RecordSimulator simulator(chain, 0.01);
  const std::vector<double> u(50, 1.0);
  simulator.run(u);
  simulator.set_free(0, 7.0);
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

TEST(ExactEngine, LongReferencesAreOneSegmentAHalfPeriod) {
  const Chain chain{{make_block("lowpass").set("corner_hz", 30.0)}};
  // A period of whole samples, and one (97 Hz) whose corners lie between samples: rounding must not cut
  // lines.
  for (const double hertz : {100.0, 97.0}) {
    ReferenceSpec spec;
    spec.frequency = Hertz{hertz};
    spec.step_s = 1e-5;
    Options options;
    options.engine = Engine::exact;
    const Result got = simulate(chain, make_reference(spec), options);
    EXPECT_LE(got.stats.steps, hertz == 100.0 ? 200u : 4u * 97u) << hertz;
    EXPECT_LT(*got.error_estimate, 1e-12);
  }
}

TEST(AutomaticEngine, PicksClosedFormElseSamplesElseEvents) {
  ReferenceSpec spec;
  spec.frequency = Hertz{5.0};
  spec.step_s = 1e-3;
  const TimeRecord u = make_reference(spec);
  const auto lowpass = [](double hertz) { return make_block("lowpass").set("corner_hz", hertz); };
  const auto engine_of = [&](const Chain& chain, double tolerance = 1e-8) {
    Options options;
    options.relative_tolerance = tolerance;
    options.absolute_tolerance = 1e-2 * tolerance;
    const Result got = simulate(chain, u, options);
    EXPECT_TRUE(got.error_estimate);
    // Judged by an independent run, the estimate is honest.
    Options fine;
    fine.engine = Engine::cvode;
    fine.relative_tolerance = 1e-12;
    fine.absolute_tolerance = 1e-14;
    fine.estimate_error = false;
    const auto reference = simulate(chain, u, fine).y;
    double most = 0.0;
    for (std::size_t i = 0; i < reference.size(); ++i)
      most = std::max(most, std::abs(got.y[i] - reference[i]));
    EXPECT_LT(most, 20.0 * *got.error_estimate + 1e-9) << to_string(got.stats.engine);
    EXPECT_LT(most, 1e-6) << to_string(got.stats.engine);
    return got.stats.engine;
  };
  EXPECT_EQ(engine_of(Chain{{lowpass(30.0), lowpass(50.0)}}), Engine::exact);
  EXPECT_EQ(engine_of(Chain{{lowpass(30.0),
                             make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.4}),
                             lowpass(50.0)}}),
            Engine::record);
  // Hysteresis behind a lag turns between samples, where its output has a corner: more and more steps, and
  // in the end events.
  const Chain turning{{lowpass(30.0), make_block("backlash").set("width", 0.07), lowpass(400.0)}};
  EXPECT_EQ(engine_of(turning), Engine::record);
  EXPECT_EQ(engine_of(turning, 1e-11), Engine::cvode);
}

}  // namespace
}  // namespace bodesmith::simulate
