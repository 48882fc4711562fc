// A name whose values, beside others, have become another effect's form.
#include "gap/search/moves.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"
#include "gap/scene.hpp"
#include "gap/signs/signs.hpp"

namespace no_names {
namespace {

using namespace bodesmith;

constexpr double kStep_s = 2e-4;

TimeRecord measured_with(const std::string& truth, unsigned seed) {
  std::vector<double> u;
  const double turn = 2.0 * std::numbers::pi * kStep_s * (1.0 + 0.1 * seed);
  for (int i = 0; i < 600; ++i)
    u.push_back(0.3 * (1.0 - std::cos(23.0 * turn * i)) + 0.2 * (1.0 - std::cos(61.0 * turn * i)));
  return measured(truth, std::move(u), kStep_s, 0.002, seed);
}

const std::string kStage =
    "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0, 0.1, 0.25, 0.45, 0.7]\nw = [1.0, 0.1, 0.08, 0.09, 0.06]\n"
    "[[block]]\ntype = \"resonator\"\ngain = 1.9\nnatural_frequency_hz = 400.0\ndamping_ratio = 0.3\n"
    "free = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\"]\n";

// A one-sided dead zone is all of it: asymmetric memory without a loop, beside an offset, would leave nothing but noise.
TEST(NoNames, AKinkOfASensorIsNotAsymmetricMemory) {
  const std::string kink =
      "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0]\nw = [1.0]\ns = [1.0]\nv = [-0.25]\n";
  const auto model = model_of(kStage);
  const auto d = gap::diagnose(
      model, gap::Study::of({measured_with(kStage + kink, 1)}, {measured_with(kStage + kink, 2)}, model), {});
  for (const auto& step : d.steps) EXPECT_NE(step.effect, "asymmetric_hysteresis");
  EXPECT_TRUE(d.verdict == gap::Verdict::partly_explained || d.verdict == gap::Verdict::unexplained);
  EXPECT_GT(d.final.holdout_rms, 1.5 * 0.002);
}

// An exponential is followed by three curves of the catalogue better than by any two: none of them acts.
TEST(NoNames, AnExponentialIsNotThreeCurves) {
  const std::string lag =
      "[[block]]\ntype = \"gain\"\ngain = 1.5\nfree = [\"gain\"]\n[[block]]\ntype = \"lowpass\"\ncorner_hz = 300.0\n";
  const auto record = [&](unsigned seed) {
    auto made = measured_with(lag, seed);
    auto bent = made.u;
    for (double& x : bent) x += 0.2 * (std::exp(-4.0 * x) - 1.0);
    const auto y = measured(lag, bent, kStep_s, 0.0, seed).y;
    const auto straight = measured(lag, made.u, kStep_s, 0.0, seed).y;
    for (std::size_t i = 0; i < y.size(); ++i) made.y[i] += y[i] - straight[i];
    return made;
  };
  const auto model = model_of(lag);
  const auto d = gap::diagnose(model, gap::Study::of({record(1)}, {record(2)}, model), {});
  EXPECT_TRUE(d.verdict == gap::Verdict::partly_explained || d.verdict == gap::Verdict::unexplained)
      << to_string(d.verdict);
}

// As much in each octave, from far below one cycle a record on: such noise has a mean and a slope, which are no sign that
// something is missing.
TEST(NoNames, NoiseOfOneOverFIsNoStraightLine) {
  const std::string lag = "[[block]]\ntype = \"lowpass\"\ncorner_hz = 300.0\nfree = [\"corner_hz\"]\n";
  const auto model = model_of(lag);
  const auto flicker = [](unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> noise(600, 0.0);
    for (double samples = 2.0; samples < 2e5; samples *= 2.0) {
      const double memory = 1.0 - 1.0 / samples;
      double x = normal(random);
      for (double& y : noise)
        y += 0.002 * (x = memory * x + std::sqrt(1.0 - memory * memory) * normal(random));
    }
    return noise;
  };
  const unsigned seed = 1;
  const auto record = [&](unsigned which, unsigned noise) {
    auto made = measured_with(lag, which);
    const auto slow = flicker(noise);
    for (std::size_t i = 0; i < made.y.size(); ++i) made.y[i] += slow[i];
    return made;
  };
  const auto d = gap::diagnose(model, gap::Study::of({record(1, seed)}, {record(2, seed + 1)}, model), {});
  EXPECT_EQ(d.verdict, gap::Verdict::nothing_missing) << seed;
}

/// Friction that holds less the one way than the other: x - .6 max(0, s) - below min(0, s), s the stop x - play(x) of radius .15.
TimeRecord held_unevenly(double below, unsigned seed) {
  auto record = measured_with("[[block]]\ntype = \"gain\"\ngain = 1.0\n", seed);
  double play = 0.0;
  for (std::size_t i = 0; i < record.u.size(); ++i) {
    const double x = record.u[i];
    play = std::max(x - 0.15, std::min(x + 0.15, play));
    const double stop = x - play;
    record.y[i] += -0.6 * std::max(0.0, stop) - below * std::min(0.0, stop);
  }
  return record;
}

// Asymmetric memory whose loop leans one way is that, alone; of equal halves it is hysteresis.
TEST(NoNames, MemoryHasTheNameOfItsHalves) {
  const auto model = model_of("[[block]]\ntype = \"gain\"\ngain = 1.05\nfree = [\"gain\"]\n");
  const auto name = [&](double below) {
    const auto d = gap::diagnose(
        model,
        gap::Study::of({held_unevenly(below, 1), held_unevenly(below, 2)}, {held_unevenly(below, 3)}, model),
        {});
    std::string names;
    for (const auto& step : d.steps) names += step.effect + " ";
    return names;
  };
  EXPECT_EQ(name(0.2), "asymmetric_hysteresis ");
  EXPECT_EQ(name(0.6), "hysteresis ");
}

// Dahl's friction whose stiffness is another one each way: dF = 3 dx (1 - F sign) (1 + skew sign).
TEST(NoNames, FrictionOfTwoStiffnessesIsAsymmetricMemory) {
  const auto record = [](unsigned seed) {
    auto made = measured_with("[[block]]\ntype = \"gain\"\ngain = 1.0\n", seed);
    double force = 0.0, before = 0.0;
    for (std::size_t i = 0; i < made.u.size(); ++i) {
      const double move = made.u[i] - before;
      const double way = move > 0.0 ? 1.0 : -1.0;
      force = way + (force - way) * std::exp(-3.0 * (1.0 + 0.5 * way) * std::abs(move));
      before = made.u[i];
      made.y[i] -= 0.15 * force;
    }
    return made;
  };
  const auto model = model_of("[[block]]\ntype = \"gain\"\ngain = 1.05\n");
  const auto d = gap::diagnose(model, gap::Study::of({record(1), record(2)}, {record(3)}, model), {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "asymmetric_hysteresis");
  EXPECT_EQ(d.verdict, gap::Verdict::explained);
}

// A lag of some samples, and one of a two-hundredth of a sample.
TEST(NoNames, AreSeenBehindOtherTerms) {
  gap::Experiments train;
  train.emplace_back(gap::TimeExperiment(measured_with(kStage, 1)));
  gap::Model model(model_of("[[block]]\ntype = \"gain\"\ngain = 1.9\n"));
  for (const char* effect : {"resonance", "offset"}) {
    std::vector<gap::Proposal> proposals;
    gap::effect_registry().get(effect).propose(gap::make_scene(model, train), proposals);
    model = proposals.front().model;
  }
  // A mode that is damped like two lags.
  const auto is_no_name = [&](double damping) {
    model.set_values(std::vector<double>{0.1 / kStep_s, damping, 0.1});
    return gap::term_is_no_name(model, 0, train);
  };
  EXPECT_FALSE(is_no_name(0.6));
  EXPECT_TRUE(is_no_name(0.70711));
}

}  // namespace
}  // namespace no_names
