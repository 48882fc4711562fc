// polynomial_hysteresis with a late branch switch (switch_delay_s), and slew_limit with feedthrough, in both
// engines.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "simulate/simulate.hpp"

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

}  // namespace
}  // namespace bodesmith::simulate
