// Which engine is chosen, and that its tolerance is met.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "chain/bent_block.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "simulate/records.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Chain;
using chain::make_block;

TEST(Engines, AutomaticMeetsItsTolerance) {
  Chain chain{{make_block("lowpass").set("corner_hz", 30.0),
               make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, -0.3, 0.2}),
               make_block("resonator").set("natural_frequency_hz", 25.0).set("damping_ratio", 0.2)}};
  const auto in = record_of(401, 0.0025, two_sines);
  Options options;
  const auto got = simulate(chain, in, options);
  ASSERT_TRUE(got.error_estimate.has_value());
  EXPECT_LT(*got.error_estimate, 1e-7);
  EXPECT_LT(max_difference(got.y, simulate(chain, in, cvode(1e-12)).y), *got.error_estimate + 1e-10);
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

// What a report says about which engine does what.
namespace bodesmith::simulate {
namespace {

using chain::make_block;

TEST(Segments, NeighboursWorkedOutAlikeAreOne) {
  const chain::Chain chain{{make_block("lowpass").set("corner_hz", 3.0), make_block("gain").set("gain", 2.0),
                            make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.3}),
                            make_block("delay").set("delay_s", 0.1)}};
  const auto record = segments_of(chain, Engine::record);
  ASSERT_EQ(record.size(), 3u);
  EXPECT_EQ(record[0].last, 2u);
  EXPECT_EQ(record[0].method, "matrix exponential on each hold");
  EXPECT_EQ(record[1].method, "value by value");
  const auto cvode = segments_of(chain, Engine::cvode);
  ASSERT_EQ(cvode.size(), 2u);
  EXPECT_EQ(cvode[0].last, 3u);
  EXPECT_EQ(cvode[1].method, "delay, shifted");
  EXPECT_EQ(segments_of(chain, Engine::exact).size(), 1u);
}

TEST(Segments, EnginesHaveNames) {
  EXPECT_EQ(to_string(Engine::automatic), "automatic");
  EXPECT_EQ(to_string(Engine::record), "record");
  EXPECT_EQ(to_string(Engine::exact), "exact");
  EXPECT_EQ(to_string(Engine::cvode), "cvode");
}

}  // namespace
}  // namespace bodesmith::simulate

// A new block type is one object and one registration: read from model.toml, it simulates in every engine.
namespace bodesmith::simulate {
namespace {

using chain::Block;

const chain::BentType& bent_block() {
  static const chain::BentType type("bent_in_simulate_test");
  return type;
}

TEST(NewBlock, SimulatesBetweenOthers) {
  chain::block_type_registry().add(bent_block());
  const chain::Chain chain = chain::model_from_node(
      parse_toml("schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 2.0\n[[block]]\n"
                 "type = \"bent_in_simulate_test\"\namount = 0.5\n",
                 "model.toml"));
  TimeRecord in;
  in.step_s = 1e-3;
  for (int i = 0; i < 200; ++i) in.u.push_back(std::sin(0.1 * i));
  for (const Engine engine : {Engine::record, Engine::cvode}) {
    Options options;
    options.engine = engine;
    const auto y = simulate(chain, in, options).y;
    ASSERT_EQ(y.size(), in.u.size());
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double u = 2.0 * in.u[i];
      EXPECT_NEAR(y[i], u + 0.25 * u * std::abs(u), 1e-7) << i;
    }
  }
}

}  // namespace
}  // namespace bodesmith::simulate

// polynomial_hysteresis with a late branch switch (switch_delay_s), and slew_limit with feedthrough, in both
// engines.
namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;

constexpr double kRising[] = {-0.30, 0.42, -0.13};
constexpr double kFalling[] = {0.16, -0.29, 0.12};

double curve(bool up, double u) {
  const double* a = up ? kRising : kFalling;
  return u + u * (a[0] + u * (a[1] + u * a[2]));
}

Block branches(double delay_s) {
  return make_block("polynomial_hysteresis")
      .set("ascending", std::vector<double>(kRising, kRising + 3))
      .set("descending", std::vector<double>(kFalling, kFalling + 3))
      .set("switch_delay_s", delay_s);
}

/// 0 to 1 and back in 2 half_period samples, again and again.
TimeRecord turning_triangle(int half_period, int halves) {
  TimeRecord r;
  r.step_s = 1e-3;
  for (int i = 0; i <= half_period * halves; ++i) {
    const int k = i % (2 * half_period);
    r.u.push_back(static_cast<double>(k < half_period ? k : 2 * half_period - k) / half_period);
  }
  return r;
}

Options by_engine(Engine engine) {
  Options o;
  o.engine = engine;
  o.estimate_error = false;
  return o;
}

TEST(SwitchDelay, TheOldBranchHoldsUntilTheSwitchActs) {
  const TimeRecord in = turning_triangle(50, 6);
  const double delay_s = 7.4e-3;
  const auto y = simulate(Chain{{branches(delay_s)}}, in, by_engine(Engine::record)).y;
  for (std::size_t i = 0; i < in.size(); ++i) {
    // Turns at 50, 100, ...; what a switch that looks at the slope delay_s ago stands at.
    const double then = static_cast<double>(i) - 7.4;
    const bool up = then <= 0.0 || static_cast<int>(std::floor(then / 50.0)) % 2 == 0;
    EXPECT_NEAR(y[i], curve(up, in.u[i]), 1e-12) << i;
  }
}

TEST(Engines, CornersThatADelayMovesBetweenSamplesAreNotMissed) {
  const TimeRecord in = turning_triangle(50, 6);
  constexpr double kLate =
      0.2;  // of a sample: the same node is the nearest one, however often the step is halved
  const Chain chain{
      {make_block("delay").set("delay_s", kLate * in.step_s), make_block("backlash").set("width", 0.3)}};
  // y follows where the gap is used up; each corner is visited between the samples.
  std::vector<double> truth = {0.0};
  double y = 0.0;
  const auto move_to = [&](double u) { y = std::clamp(y, u - 0.15, u + 0.15); };
  for (std::size_t i = 1; i < in.size(); ++i) {
    move_to(in.u[i - 1]);
    move_to(in.u[i] + kLate * (in.u[i - 1] - in.u[i]));
    truth.push_back(y);
  }
  const Result automatic = simulate(chain, in);
  EXPECT_LT(max_difference(automatic.y, truth), 1e-8);
  EXPECT_LT(*automatic.error_estimate, 1e-7);
  Options by_samples;
  by_samples.engine = Engine::record;
  const Result record = simulate(chain, in, by_samples);
  const double left = max_difference(record.y, truth);
  EXPECT_GT(left, 1e-3);  // a fifth of a sample's slope at each turn
  EXPECT_NEAR(*record.error_estimate, left, 0.01 * left);
}

TEST(SwitchDelay, ZeroIsTheSwitchedCubicItself) {
  const TimeRecord in = turning_triangle(40, 5);
  const auto late = simulate(Chain{{branches(0.0)}}, in, by_engine(Engine::record)).y;
  for (std::size_t i = 1; i < in.size(); ++i) {
    if (i % 40 == 0) continue;  // the turn itself
    EXPECT_NEAR(late[i], curve(in.u[i] > in.u[i - 1], in.u[i]), 1e-12) << i;
  }
}

TEST(SwitchDelay, TurnsFasterThanTheSwitchAreStillFollowedLate) {
  // The input turns every 5 ms, the switch is 12 ms late: it stands where the slope was 12 ms ago.
  const TimeRecord in = turning_triangle(5, 60);
  const auto y = simulate(Chain{{branches(12.5e-3)}}, in, by_engine(Engine::record)).y;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double then = static_cast<double>(i) - 12.5;
    const bool up = then <= 0.0 || static_cast<int>(std::floor(then / 5.0)) % 2 == 0;
    EXPECT_NEAR(y[i], curve(up, in.u[i]), 1e-12) << i;
  }
}

TEST(SwitchDelay, BothEnginesAgreeBehindALag) {
  const TimeRecord in = turning_triangle(50, 6);
  const Chain chain{{branches(7.0e-3), make_block("lowpass").set("corner_hz", 40.0)}};
  const auto record = simulate(chain, in, by_engine(Engine::record)).y;
  const auto cvode = simulate(chain, in, by_engine(Engine::cvode)).y;
  ASSERT_EQ(record.size(), cvode.size());
  for (std::size_t i = 0; i < record.size(); ++i) EXPECT_NEAR(record[i], cvode[i], 2e-3) << i;
}

TEST(SlewFeedthrough, BothEnginesAndALoopAgree) {
  TimeRecord in;
  in.step_s = 1e-3;
  for (int i = 0; i < 400; ++i) in.u.push_back(i / 60 % 2 == 0 ? 0.02 * (i % 60) : -0.5);
  const Chain chain{{make_block("slew_limit").set("rate_per_s", 9.0).set("feedthrough", 0.08)}};
  const auto record = simulate(chain, in, by_engine(Engine::record)).y;
  const auto cvode = simulate(chain, in, by_engine(Engine::cvode)).y;
  double x = 0.0;
  double u = in.u[0];
  for (std::size_t i = 0; i < in.size(); ++i) {
    const int parts = 2000;
    for (int k = 1; i > 0 && k <= parts; ++k) {
      const double at = u + (in.u[i] - u) * k / parts;
      x += std::clamp(at - x, -9.0 * in.step_s / parts, 9.0 * in.step_s / parts);
    }
    u = in.u[i];
    EXPECT_NEAR(record[i], x + 0.08 * (u - x), 1e-4) << i;
    EXPECT_NEAR(record[i], cvode[i], 1e-6) << i;
  }
}

TEST(SlewFeedthrough, BehindALagIsTheLimitAndAPartOfWhatItLacks) {
  TimeRecord in;
  in.step_s = 1e-3;
  for (int i = 0; i < 400; ++i) in.u.push_back(std::sin(0.04 * i));
  const chain::Block lag = make_block("lowpass").set("corner_hz", 20.0);
  const auto behind = [&](double feedthrough) {
    const chain::Block limit =
        make_block("slew_limit").set("rate_per_s", 20.0).set("feedthrough", feedthrough);
    return simulate(Chain{{lag, limit}}, in, by_engine(Engine::cvode)).y;
  };
  const auto u = simulate(Chain{{lag}}, in, by_engine(Engine::cvode)).y, x = behind(0.0), y = behind(0.3);
  for (std::size_t i = 0; i < in.size(); ++i) EXPECT_NEAR(y[i], x[i] + 0.3 * (u[i] - x[i]), 1e-7) << i;
}

}  // namespace
}  // namespace bodesmith::simulate
