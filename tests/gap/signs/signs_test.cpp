// Signs that what is left is more than noise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "chain/registry.hpp"
#include "gap/signs/signs.hpp"
#include "numeric/random.hpp"
#include "simulate/record/record_simulator.hpp"

namespace {

using namespace bodesmith::gap;

Leftover noise_of_colour(double memory, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Leftover l;
  l.step_s = 1e-3;
  double x = 0.0;
  for (int i = 0; i < 2000; ++i) {
    x = memory * x + normal(random);
    l.residual.push_back(x * std::sqrt(1.0 - memory * memory));
  }
  return l;
}

/// So many times through a lag of five samples.
std::vector<double> smoothed(std::vector<double> x, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    double smooth = 0.0;
    for (double& v : x) v = smooth += 0.2 * (v - smooth);
  }
  return x;
}

// A jump that a straight line was put through (a drift was named), four deviations of the noise high; no noise of any colour and no
// sine under noise has such steps.
TEST(Signs, AJumpUnderTheNoiseOfSingleSamplesIsSeen) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto jump = noise_of_colour(0.0, seed);
    auto sine = jump;
    for (std::size_t i = 0; i < 2000; ++i) {
      const double t = static_cast<double>(i) / 2000.0;
      jump.residual[i] += 4.0 * ((t > 0.6 ? 1.0 : 0.0) - t);
      sine.residual[i] += 3.0 * std::sin(40.0 * t);
    }
    EXPECT_TRUE(jumps(jump).found()) << seed;
    EXPECT_FALSE(jumps(sine).found()) << seed;
    for (const double memory : {0.0, 0.9, 0.99, 0.999})
      EXPECT_FALSE(jumps(noise_of_colour(memory, seed + 100)).found()) << seed << " " << memory;
  }
}

// A third of it comes back 37 samples later: no feature of the present, and between the earlier samples that are looked at.
TEST(Signs, AnEchoDependsOnEarlierOutputs) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto record = [&](unsigned which) {
      auto l = noise_of_colour(0.0, which);
      l.input = l.output = smoothed(noise_of_colour(0.0, which + 100).residual, 4);
      return l;
    };
    auto a = record(2 * seed), b = record(2 * seed + 1);
    EXPECT_FALSE(depends_on_signals({a, b}).found()) << seed;
    for (auto* l : {&a, &b}) {
      for (std::size_t i = 37; i < 2000; ++i) l->residual[i] += 15.0 * l->output[i - 37];
    }
    EXPECT_TRUE(depends_on_signals({a, b}).found()) << seed;
  }
}

/// Of a smooth drive through a gain, with noise.
Leftover curve_left(unsigned seed, double wave) {
  Leftover l = noise_of_colour(0.0, seed);
  const double phase = 0.1 * seed;
  for (std::size_t i = 0; i < 2000; ++i) {
    const double t = static_cast<double>(i) / 2000.0;
    const double u = std::sin(2.0 * std::numbers::pi * 17.0 * t + phase) +
                     0.6 * std::sin(2.0 * std::numbers::pi * 41.0 * t + 3.0 * phase);
    l.input.push_back(u);
    l.output.push_back(5.0 * u);
    l.residual[i] += wave * std::sin(8.0 * u);
  }
  return l;
}

// Two and a half waves over the range: nothing that powers could follow.
TEST(Signs, AStaticCurveOfAnyFormDependsOnTheSignals) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    EXPECT_TRUE(depends_on_signals({curve_left(seed, 1.0), curve_left(seed + 50, 1.0)}).found()) << seed;
    EXPECT_FALSE(depends_on_signals({curve_left(seed, 0.0), curve_left(seed + 50, 0.0)}).found()) << seed;
  }
}

// The same in front of a resonance, which no curve of what comes out of it follows.
TEST(Signs, ACurveInFrontOfDynamicsDependsOnTheInputThroughThem) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Leftover l = curve_left(seed, 0.0);
    l.dynamics.blocks = {bodesmith::chain::make_block("resonator")
                             .set("gain", 1.0)
                             .set("natural_frequency_hz", 30.0)
                             .set("damping_ratio", 0.05)};
    const auto through = [&](std::vector<double> v) {
      return bodesmith::simulate::RecordSimulator(l.dynamics, l.step_s).run_once(v);
    };
    std::vector<double> waves;
    for (const double u : l.input) waves.push_back(0.3 * std::sin(8.0 * u));
    waves = through(waves);
    l.output = through(l.input);
    EXPECT_FALSE(depends_on_signals({l}).found()) << seed;
    for (std::size_t i = 0; i < 2000; ++i) l.residual[i] += waves[i];
    EXPECT_TRUE(depends_on_signals({l}).found()) << seed;
    l.dynamics.blocks.clear();
    EXPECT_FALSE(depends_on_signals({l}).found()) << seed;
  }
}

// What a parabola leaves of a kink, of the noise's own size; one record is enough. Noise of any colour makes no such thing, nor does noise that
// rings with a mode in the drive's band.
TEST(Signs, WhatACurveLeavesOfAKinkDependsOnTheSignalsAndNoNoiseDoes) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    for (const double memory : {0.0, 0.9, 0.99}) {
      auto record = curve_left(seed, 0.0);
      record.residual = noise_of_colour(memory, seed).residual;
      EXPECT_FALSE(depends_on_signals({record}).found()) << seed << " " << memory;
      for (std::size_t i = 0; i < 2000; ++i) {
        const double u = record.input[i];
        record.residual[i] += 8.0 * (std::max(u, 0.0) - 0.5 * u - 0.25 * u * u);
      }
      EXPECT_TRUE(depends_on_signals({record}).found()) << seed << " " << memory;
    }
    auto ringing = curve_left(seed, 0.0);
    double before = 0.0, earlier = 0.0;
    for (double& e : ringing.residual) {
      const double now = 1.98 * before - 0.99 * earlier + e;
      earlier = std::exchange(before, now);
      e = now;
    }
    EXPECT_FALSE(depends_on_signals({ringing}).found()) << seed;
  }
}

/// A few lines, and a residual of the same lines: what surrogates of it share with slow gains is large by itself.
Leftover few_lines(unsigned seed, bool wandering) {
  Leftover l = noise_of_colour(0.0, seed);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  double cosine[3] = {}, sine[3] = {};
  const double memory = std::exp(-1.0 / 300.0);
  for (std::size_t i = 0; i < 2000; ++i) {
    double output = 0.0, noise = 0.0;
    for (std::size_t line = 0; line < 3; ++line) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>((line + 2) * i) / 500.0;
      output += std::sin(angle + static_cast<double>(line));
      cosine[line] = memory * cosine[line] + normal(random);
      sine[line] = memory * sine[line] + normal(random);
      noise +=
          (cosine[line] * std::cos(angle) + sine[line] * std::sin(angle)) * std::sqrt(1.0 - memory * memory);
    }
    const double gain = std::sin(2.0 * std::numbers::pi * 1.7 * static_cast<double>(i) / 2000.0 + 0.4);
    l.output.push_back(10.0 * output);
    l.residual[i] = 0.1 * l.residual[i] + (wandering ? gain * output : noise);
  }
  return l;
}

TEST(Signs, AGainThatWandersIsSeenOnFewLinesAndNarrowNoiseIsNoGain) {
  int alarms = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    EXPECT_TRUE(gain_varies(few_lines(seed, true)).found()) << seed;
    alarms += gain_varies(few_lines(seed, false)).found() ? 1 : 0;
  }
  EXPECT_EQ(alarms, 0);
}

TEST(Signs, ANarrowNotchStandsApartAndNoiseOfAnyLevelDoesNot) {
  const auto errors = [](unsigned seed, double rise) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Leftover l;
    for (int i = 0; i < 200; ++i) {
      for (int part = 0; part < 2; ++part) l.response.push_back(std::pow(rise, i / 200.0) * normal(random));
    }
    return l;
  };
  for (unsigned seed = 1; seed < 60; ++seed) EXPECT_FALSE(stands_apart(errors(seed, 30.0)).found()) << seed;
  auto notch = errors(1, 1.0);
  notch.response[160] += 25.0;
  EXPECT_TRUE(stands_apart(notch).found());
}

/// The strength of each sign in one record that has them all a little, to a hundredth: what is learnt from which part, how many
/// cosines and surrogates there are.
TEST(Signs, StrengthsAreThoseThatWereKept) {
  bodesmith::Random random(3);
  const auto made = [&](double phase) {
    Leftover l;
    l.step_s = 1e-3;
    double slow = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const double t = i / 1000.0, u = std::sin(40.0 * t + phase) + 0.4 * std::sin(97.0 * t),
                   e = random.uniform() - 0.5;
      slow += 0.05 * (e - slow);
      l.input.push_back(u);
      l.output.push_back(2.0 * u);
      l.residual.push_back(e + 3.0 * slow + 0.3 * u * u + 0.2 * u * std::cos(3.0 * t) +
                           (t > 0.7 ? 0.5 : 0.0) - 0.4 * t + 0.2 * std::sin(900.0 * t));
    }
    for (int i = 0; i < 120; ++i)
      l.response.push_back(0.2 * (random.uniform() - 0.5) + 0.1 * std::sin(0.1 * i) +
                           (i / 2 == 31 ? 2.0 : 0.0));
    return l;
  };
  const Leftover a = made(0.0), b = made(1.0);
  std::string all;
  for (const Sign& one : {depends_on_signals({a, b}), spectral_line(a), jumps(a), gain_varies(a),
                          smooth_over_frequency(a), stands_apart(a)})
    all += fmt::format("{} {:.2f}\n", to_string(one.kind), one.strength);
  EXPECT_EQ(all,
            "the residual depends on input and output 0.90\n"
            "a line stands in the residual's spectrum 1.19\n"
            "the residual jumps 0.89\n"
            "the gain varies with time 0.83\n"
            "neighbouring frequencies err alike 0.16\n"
            "single frequencies err far more than those around them 6.53\n");
}

}  // namespace
