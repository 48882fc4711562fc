// Margins, group delay and time responses of k/(1 + s/a)^3 against their closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lti/bulk_response.hpp"
#include "lti/loop_margins.hpp"
#include "lti/time_response.hpp"

namespace bodesmith {
namespace {

constexpr double kCorner = 1000.0;  // rad/s

Sections three_lags(double k, double delay_s = 0.0) {
  Sections out;
  out.gain = k;
  for (int i = 0; i < 3; ++i) out.sections.push_back({kCorner, {}, {-kCorner}});
  out.delay_s = delay_s;
  return out;
}

LoopMargins margins_of(const Sections& loop, int count = 60) {
  return loop_margins([&loop](Hertz f) { return loop.response(f.rad_s()); },
                      log_grid({Hertz{1.0}, Hertz{1e5}}, count));
}

TEST(LoopMargins, OfThreeLagsAreTheClosedForms) {
  const LoopMargins m = margins_of(three_lags(4.0));
  ASSERT_EQ(m.gain_crossings.size(), 1u);
  ASSERT_EQ(m.phase_crossings.size(), 1u);
  const double x = std::sqrt(std::pow(4.0, 2.0 / 3.0) - 1.0);
  const double margin = std::numbers::pi - 3.0 * std::atan(x);
  EXPECT_NEAR(m.gain_crossings[0].frequency.rad_s().value / (kCorner * x), 1.0, 1e-11);
  EXPECT_NEAR(m.least_phase_margin()->phase_margin_deg, to_degrees(margin), 1e-8);
  EXPECT_NEAR(m.gain_crossings[0].delay_margin_s, margin / (kCorner * x), 1e-14);
  EXPECT_NEAR(m.phase_crossings[0].frequency.rad_s().value / (kCorner * std::sqrt(3.0)), 1.0, 1e-11);
  EXPECT_NEAR(m.least_gain_margin()->gain_margin_db, to_decibel(2.0), 1e-9);
  // |1 + L| beside -1: at sqrt(3) a it is 1/2; the peak of 1/|1 + L| lies a little below that frequency.
  EXPECT_GT(m.max_sensitivity, 2.0);
  EXPECT_LT(m.max_sensitivity_at.rad_s().value, kCorner * std::sqrt(3.0));
  const Json json = to_json(m);
  EXPECT_EQ(json["gain_crossings"][0]["phase_margin_deg"], m.gain_crossings[0].phase_margin_deg);
  EXPECT_EQ(json["phase_crossings"][0]["gain_margin_db"], m.phase_crossings[0].gain_margin_db);
}

LoopMargins margins_of_data(const Sections& loop, int count) {
  const std::vector<Hertz> grid = log_grid({Hertz{0.1}, Hertz{1e6}}, count);
  std::vector<std::complex<double>> values;
  for (const Hertz f : grid) values.push_back(loop.response(f.rad_s()));
  return loop_margins(grid, values);
}

TEST(LoopMargins, OfDataAreThoseOfTheSystemTheyWereTakenFrom) {
  // Straight lines between 60 points a decade leave (ln 10/60)^2/8 = 2e-4 of the curvature.
  const LoopMargins of_data = margins_of_data(three_lags(4.0), 421);
  const LoopMargins of_system = margins_of(three_lags(4.0));
  ASSERT_EQ(of_data.gain_crossings.size(), 1u);
  EXPECT_NEAR(of_data.phase_margin_deg(), of_system.phase_margin_deg(), 2e-2);
  EXPECT_NEAR(*of_data.gain_margin_db(), to_decibel(2.0), 5e-3);
  EXPECT_NEAR(of_data.max_sensitivity, of_system.max_sensitivity, 1e-3 * of_system.max_sensitivity);
  EXPECT_NEAR(of_data.gain_crossings[0].frequency.value / of_system.gain_crossings[0].frequency.value, 1.0,
              2e-4);
}

TEST(LoopMargins, AreBelowZeroWhereTheClosedLoopIsUnstable) {
  // 1 + k/(1 + s)^3 has roots to the right beyond k = 8 (Routh); at 8 both margins vanish.
  for (const double k : {6.0, 7.9, 8.1, 10.0}) {
    const LoopMargins m = margins_of(three_lags(k));
    EXPECT_EQ(m.phase_margin_deg() > 0.0, k < 8.0) << k;
    EXPECT_NEAR(*m.gain_margin_db(), to_decibel(8.0 / k), 1e-9) << k;
  }
  EXPECT_NEAR(margins_of(three_lags(8.0)).phase_margin_deg(), 0.0, 1e-8);
  EXPECT_EQ(margins_of(three_lags(0.4)).phase_margin_deg(), 180.0);
  // Positive feedback: -0.5 at rest may grow twofold, and no phase crossing says so.
  EXPECT_NEAR(*margins_of(three_lags(-0.5)).gain_margin_db(), to_decibel(2.0), 5e-3);
  Sections flat;
  flat.gain = 0.5;
  EXPECT_FALSE(margins_of(flat).gain_margin_db().has_value());
}

TEST(LoopMargins, SeveralCrossingsAreAllFound) {
  // A resonance behind an integrator: |L| = w0^2 (Ki/w)/|w0^2 - w^2 + 2 j d w0 w| is 1 at the positive roots of
  // w^2 ((1 - w^2)^2 + (2 d w)^2) = Ki^2, w0 = 1. With d = .01, Ki = .2: three of them.
  Sections loop;
  loop.sections.push_back({0.2, {}, {0.0}});
  const double w = std::sqrt(1.0 - 1e-4);
  loop.sections.push_back({1.0, {}, {{-0.01, w}, {-0.01, -w}}});
  const auto square = [](double x) { return x * ((1.0 - x) * (1.0 - x) + 4e-4 * x) - 0.04; };
  const LoopMargins m = loop_margins([&loop](Hertz f) { return loop.response(f.rad_s()); },
                                     log_grid({Hertz{1e-3}, Hertz{10.0}}, 400));
  ASSERT_EQ(m.gain_crossings.size(), 3u);
  for (const auto& c : m.gain_crossings) {
    const double x = std::pow(c.frequency.rad_s().value, 2);
    EXPECT_NEAR(square(x), 0.0, 1e-12);
  }
  // At resonance L = -Ki/(2 d): the gain is 20 dB too great.
  ASSERT_EQ(m.phase_crossings.size(), 1u);
  EXPECT_NEAR(m.phase_crossings[0].frequency.rad_s().value, 1.0, 1e-11);
  EXPECT_NEAR(*m.gain_margin_db(), -20.0, 1e-9);
}

// Over x = ln f: |L| = exp(.01 - x^2) is 1 twice about f = 1, the phase (x - ln 20)^2 - .02 - pi is -pi twice about f = 20.
TEST(LoopMargins, TwoCrossingsWithinAStepOfTheGridAreFound) {
  const Loop loop = [](Hertz f) {
    const double x = std::log(f.value), far = x - std::log(20.0);
    return std::polar(std::exp(0.01 - x * x), far * far - 0.02 - std::numbers::pi);
  };
  const LoopMargins m = loop_margins(loop, log_grid({Hertz{0.013}, Hertz{150.0}}, 14));
  ASSERT_EQ(m.gain_crossings.size(), 2u);
  EXPECT_NEAR(m.gain_crossings[0].frequency.value, std::exp(-0.1), 1e-10);
  EXPECT_NEAR(m.gain_crossings[1].frequency.value, std::exp(0.1), 1e-10);
  EXPECT_EQ(gain_crossings(loop, log_grid({Hertz{0.013}, Hertz{150.0}}, 14)).size(), 2u);
  std::vector<double> at_20;
  for (const auto& c : m.phase_crossings) {
    if (std::abs(std::log(c.frequency.value / 20.0)) < 0.5)
      at_20.push_back(std::log(c.frequency.value / 20.0));
  }
  ASSERT_EQ(at_20.size(), 2u);
  EXPECT_NEAR(at_20[0], -std::sqrt(0.02), 1e-10);
  EXPECT_NEAR(at_20[1], std::sqrt(0.02), 1e-10);
}

TEST(LoopMargins, StabilityIsThatOfTheRouthCriterion) {
  EXPECT_EQ(closed_loop_is_stable(three_lags(7.9)), true);  // 8 is the limit
  EXPECT_EQ(closed_loop_is_stable(three_lags(8.1)), false);
  EXPECT_EQ(closed_loop_is_stable(three_lags(-0.9)), true);  // DC: 1 + L = 0.1
  EXPECT_EQ(closed_loop_is_stable(three_lags(-1.1)), false);
  // The delay margin is where a delay makes it unstable.
  const double limit = margins_of(three_lags(4.0)).gain_crossings[0].delay_margin_s;
  EXPECT_EQ(closed_loop_is_stable(three_lags(4.0, 0.99 * limit)), true);
  EXPECT_EQ(closed_loop_is_stable(three_lags(4.0, 1.01 * limit)), false);
  // k/(s (1 + s/a)^2): stable below k = 2 a.
  for (const double k : {1.9, 2.1}) {
    Sections integrator = three_lags(1.0);
    integrator.sections[0] = {k * kCorner, {}, {0.0}};
    EXPECT_EQ(closed_loop_is_stable(integrator), k < 2.0) << k;
  }
  Sections unstable = three_lags(1.0);
  unstable.sections[0].poles = {kCorner};
  EXPECT_FALSE(closed_loop_is_stable(unstable).has_value());
}

TEST(GroupDelay, OfThreeLagsAndADelayIsTheClosedForm) {
  const Sections sections = three_lags(1.0, 1e-4);
  for (const double x : {0.01, 1.0, 3.0}) {
    const double wanted = 3.0 / (kCorner * (1.0 + x * x)) + 1e-4;
    EXPECT_NEAR(group_delay_s(sections, RadPerSecond{x * kCorner}), wanted, 1e-15);
    const auto response = [&](Hertz f) { return sections.response(f.rad_s()); };
    EXPECT_NEAR(group_delay_s(response, RadPerSecond{x * kCorner}.hz()), wanted, 1e-7 * wanted);
  }
}

TEST(TimeResponse, OfThreeLagsIsTheClosedFormLaterByTheDelay) {
  const double delay = 1.234e-4;
  const Sections sections = three_lags(2.0, delay);
  const TimeResponse r = time_response(sections, 0.02, 801);
  for (std::size_t i = 0; i < r.time_s.size(); ++i) {
    const double x = kCorner * (r.time_s[i] - delay);
    const double step = x < 0.0 ? 0.0 : 2.0 * (1.0 - std::exp(-x) * (1.0 + x + 0.5 * x * x));
    const double impulse = x < 0.0 ? 0.0 : kCorner * x * x * std::exp(-x);
    EXPECT_NEAR(r.step[i], step, 1e-12);
    EXPECT_NEAR(r.impulse[i], impulse, 1e-9);
  }
  EXPECT_EQ(r.direct, 0.0);
  ASSERT_TRUE(r.figures);
  EXPECT_DOUBLE_EQ(r.figures->final_value, 2.0);
  // Rise of three equal lags from 10 to 90 %: x = 1.10207 to 5.32232.
  EXPECT_NEAR(r.figures->rise_s, (5.32232 - 1.10207) / kCorner, 1e-8);
  EXPECT_EQ(r.figures->overshoot_percent, 0.0);
}

TEST(TimeResponse, FiguresDoNotHangOnTheTimesAskedFor) {
  // Damping .3 at 1000 rad/s: beyond by exp(-pi .3/sqrt(1 - .3^2)); a lag of 10 us: ln 9 and ln 50 of them, from its delay on.
  Sections ringing, lag;
  ringing.sections.push_back(
      {1e6, {}, {Complex(-300.0, 1000.0 * std::sqrt(0.91)), Complex(-300.0, -1000.0 * std::sqrt(0.91))}});
  lag.sections.push_back({-3e5, {}, {-1e5}});
  lag.delay_s = 1e-3;
  for (const int count : {2, 1000}) {
    const TimeResponse one = time_response(ringing, 0.1, count), other = time_response(lag, 0.1, count);
    ASSERT_TRUE(one.figures && other.figures);
    EXPECT_NEAR(one.figures->overshoot_percent, 100.0 * std::exp(-std::numbers::pi * 0.3 / std::sqrt(0.91)),
                1e-3);
    EXPECT_DOUBLE_EQ(other.figures->final_value, -3.0);
    EXPECT_NEAR(other.figures->rise_s, std::log(9.0) * 1e-5, 1e-12);
    EXPECT_NEAR(other.figures->settling_s, 1e-3 + std::log(50.0) * 1e-5, 1e-12);
    // The last time that the ringing is 2 % off, by its closed form.
    double settled = 0.0;
    for (double t = 0.02; t > 0.0 && settled == 0.0; t -= 1e-7) {
      const double w = 1000.0 * std::sqrt(0.91);
      if (std::abs(std::exp(-300.0 * t) * (std::cos(w * t) + 300.0 / w * std::sin(w * t))) > 0.02)
        settled = t;
    }
    EXPECT_NEAR(one.figures->settling_s, settled, 2e-7);
  }
  Sections unstable = lag, high_pass = lag;
  unstable.sections[0].poles = {1e5};
  high_pass.sections[0].zeros = {0.0};
  EXPECT_FALSE(time_response(unstable, 1e-4, 5).figures);
  EXPECT_FALSE(time_response(high_pass, 1e-4, 5).figures);
}

TEST(TimeResponse, WhatGoesStraightThroughIsTold) {
  Sections lead;
  lead.sections.push_back({3.0, {-10.0}, {-20.0}});
  const TimeResponse r = time_response(lead, 1.0, 3);
  EXPECT_EQ(r.direct, 3.0);
  EXPECT_NEAR(r.step[0], 3.0, 1e-14);
  EXPECT_NEAR(r.step[2], 1.5 + 1.5 * std::exp(-20.0), 1e-12);
}

}  // namespace
}  // namespace bodesmith
