// Two effects that one name of many unknowns explains as well, of which one hides the other's size, or that stand on one side of
// zero alone: each gets its own name.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"
#include "gap/scene.hpp"
#include "gap/search/shortlist.hpp"

namespace two_names {
namespace {

using namespace bodesmith;

constexpr double kStep_s = 2e-4;
constexpr int kSamples = 900;

/// Two sines, a slow one and a faster one, between 0 and 1: from rest.
std::vector<double> one_sided(double slow_hz, double fast_hz) {
  std::vector<double> u;
  for (int i = 0; i < kSamples; ++i) {
    const double t = kStep_s * i;
    const double slow = 1.0 - std::cos(2.0 * std::numbers::pi * slow_hz * t);
    const double fast = 1.0 - std::cos(2.0 * std::numbers::pi * fast_hz * t);
    u.push_back(0.3 * slow + 0.2 * fast);
  }
  return u;
}

gap::Diagnosis diagnosed(const std::string& base, const std::string& truth, double noise) {
  const auto model = model_of(base);
  std::vector<TimeRecord> train = {measured(truth, one_sided(23.0, 61.0), kStep_s, noise, 1)};
  return gap::diagnose(
      model,
      gap::Study::of(std::move(train), {measured(truth, one_sided(17.0, 49.0), kStep_s, noise, 2)}, model),
      {});
}

std::set<std::string> names_of(const gap::Diagnosis& d) {
  std::set<std::string> names;
  for (const auto& step : d.steps) names.insert(step.effect);
  return names;
}

const std::string kPlays =
    "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0, 0.1, 0.25, 0.45, 0.7]\nw = [1.0, 0.1, 0.08, 0.09, 0.06]\n";
const std::string kResonator =
    "[[block]]\ntype = \"resonator\"\ngain = 0.8\nnatural_frequency_hz = 400.0\ndamping_ratio = 0.2\n"
    "free = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\"]\n";

TEST(TwoNames, AnOffsetAndALimitAreNotAsymmetricMemory) {
  const auto d = diagnosed(kPlays + kResonator,
                           "[[block]]\ntype = \"gain\"\ngain = 1.0\noffset = -0.06\n" + kPlays + kResonator +
                               "[[block]]\ntype = \"saturation\"\nlower = -9.0\nupper = 0.7\n",
                           0.003);
  EXPECT_EQ(names_of(d), (std::set<std::string>{"offset", "saturation"}));
}

// The line crosses zero in the middle of the record: a constant alone, and a line from zero alone, leave as much as before.
TEST(TwoNames, AConstantAndALineThatExplainNothingAlone) {
  const auto d = diagnosed(kResonator,
                           kResonator + "[[block]]\ntype = \"gain\"\ngain = 1.0\noffset = -0.03\n" +
                               "[[block]]\ntype = \"drift\"\nrate_per_s = 0.33\n",
                           0.002);
  EXPECT_EQ(names_of(d), (std::set<std::string>{"drift", "offset"}));
  EXPECT_LT(d.final.train_rms, 1.1 * 0.002);
}

// The delay takes four fifths of what the drift leaves, and less than a twelfth of the first gap.
TEST(TwoNames, ADelayUnderADriftOfManyTimesItsSizeIsNamed) {
  const std::string base = kPlays + "[[block]]\ntype = \"gain\"\ngain = 2.0\nfree = [\"gain\"]\n";
  const auto d = diagnosed(
      base,
      base + "[[block]]\ntype = \"delay\"\ndelay_s = 4e-4\n[[block]]\ntype = \"drift\"\nrate_per_s = 20.0\n",
      0.002);
  EXPECT_EQ(names_of(d), (std::set<std::string>{"drift", "time_delay"}));
  EXPECT_LT(d.final.train_rms, 1.1 * 0.002);
  EXPECT_LT(d.before(d.steps.size() - 1).train_rms, 0.08 * d.refitted.train_rms);
}

TEST(TwoNames, WhatOnlyTheHeldOutRecordHoldsIsNotNothing) {
  const std::string base = "[[block]]\ntype = \"gain\"\ngain = 2.0\nfree = [\"gain\"]\n";
  const auto model = model_of(base);
  const std::string limited = base + "[[block]]\ntype = \"saturation\"\nlower = -9.0\nupper = 1.2\n";
  std::vector<double> small = one_sided(23.0, 61.0);
  for (double& u : small) u *= 0.5;
  std::vector<TimeRecord> train = {measured(limited, small, kStep_s, 0.005, 1)};
  const auto d = gap::diagnose(
      model,
      gap::Study::of(std::move(train), {measured(limited, one_sided(17.0, 49.0), kStep_s, 0.005, 2)}, model),
      {});
  EXPECT_TRUE(d.steps.empty());
  EXPECT_EQ(d.verdict, gap::Verdict::unexplained);
}

TEST(TwoNames, ADeadZoneThatASignalNeverShowsIsAnOffset) {
  const std::string base = "[[block]]\ntype = \"gain\"\ngain = 2.0\nfree = [\"gain\"]\n";
  const auto d = diagnosed(base, base + "[[block]]\ntype = \"gain\"\ngain = 1.0\noffset = -0.1\n", 0.005);
  ASSERT_EQ(names_of(d), std::set<std::string>{"offset"});
  const auto& ties = d.steps.front().tied_with;
  EXPECT_EQ(std::count(ties.begin(), ties.end(), "dead_zone"), 0);
}

/// What the first look promises of a delay when the model's free gain stands at this value.
double promise_of_a_delay(double gain) {
  const std::string lag = "[[block]]\ntype = \"lowpass\"\ncorner_hz = 300.0\n";
  const auto record = measured(lag + "[[block]]\ntype = \"delay\"\ndelay_s = 2e-4\n", one_sided(23.0, 61.0),
                               kStep_s, 1e-4, 3);
  const gap::Model model(
      model_of("[[block]]\ntype = \"gain\"\ngain = " + std::to_string(gain) + "\nfree = [\"gain\"]\n" + lag));
  const gap::Experiments look = {gap::TimeExperiment(record)};
  std::vector<gap::Proposal> proposals;
  gap::effect_registry().get("time_delay").propose(gap::make_scene(model, look), proposals);
  return gap::shortlist(model, std::move(proposals), look).front().score;
}

// As in a chain from which a term was just taken out: what refitting will explain is no reason to promise less.
TEST(Shortlist, APromiseIsAShareOfWhatTheFreeValuesLeave) {
  EXPECT_GT(promise_of_a_delay(1.0), 0.9);
  EXPECT_GT(promise_of_a_delay(3.0), 0.9);
}

}  // namespace
}  // namespace two_names
