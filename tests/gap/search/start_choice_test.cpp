#include "gap/search/start_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/documents/json.hpp"
#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"
#include "gap/report/files.hpp"

namespace {

using namespace bodesmith;
using chain::Start;

constexpr double kInterval = 1e-3;
constexpr double kBias = 1.5;

std::vector<double> waves(double from, double hz) {
  std::vector<double> u;
  for (int i = 0; i < 1500; ++i) {
    const double t = kInterval * i;
    u.push_back(from + std::sin(2.0 * std::numbers::pi * hz * t) * (1.0 - 0.5 * t) +
                0.4 * std::sin(2.0 * std::numbers::pi * 2.7 * hz * t));
  }
  return u;
}

/// A record of this input, its output still to come.
TimeRecord driven_by(std::vector<double> u) {
  TimeRecord r;
  r.file = "made.csv";
  r.step_s = kInterval;
  r.u = std::move(u);
  return r;
}

/// y' = 2 pi hz (1.3 u - y) by small Euler steps, then cut off at `top`, with a little noise.
TimeRecord lagging(std::vector<double> u, double hz, double top, double before, unsigned seed) {
  TimeRecord r = driven_by(std::move(u));
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.003);
  constexpr int kParts = 200;
  double y = 1.3 * before;
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    r.y.push_back(std::min(y, top) + noise(random));
    if (i + 1 == r.u.size()) break;
    for (int k = 0; k < kParts; ++k) {
      const double in = r.u[i] + (r.u[i + 1] - r.u[i]) * (k + 0.5) / kParts;
      y += 2.0 * std::numbers::pi * hz * (1.3 * in - y) * kInterval / kParts;
    }
  }
  return r;
}

/// u and a play of width 1 that rests before it moves, with a little noise.
TimeRecord playing(std::vector<double> u, unsigned seed) {
  TimeRecord r = driven_by(std::move(u));
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.003);
  double state = r.u.front();
  for (const double v : r.u) {
    state = std::max(v - 0.5, std::min(v + 0.5, state));
    r.y.push_back(1.2 * state + noise(random));
  }
  return r;
}

const char* const kLag =
    "[[block]]\ntype = \"gain\"\ngain = 1.2\nfree = [\"gain\"]\n"
    "[[block]]\ntype = \"lowpass\"\ncorner_hz = 4.5\nfree = [\"corner_hz\"]\n";
const char* const kGain = "[[block]]\ntype = \"gain\"\ngain = 1.0\nfree = [\"gain\"]\n";

gap::Diagnosis diagnosed(const chain::Chain& base, const TimeRecord& train, const TimeRecord& holdout) {
  gap::SearchOptions options;
  options.threads = 1;
  return gap::diagnose(base, gap::Study::of({train}, {holdout}, base), options);
}

TEST(StartChoice, ARecordAtRestUnderBiasIsExplainedFromEquilibrium) {
  const auto base = model_of(kLag);
  const auto d = diagnosed(base, lagging(waves(kBias, 2.0), 4.0, 2.6, kBias, 1),
                           lagging(waves(kBias, 3.1), 4.0, 2.6, kBias, 2));
  ASSERT_TRUE(d.start.has_value());
  EXPECT_EQ(d.start->chosen, Start::equilibrium);
  EXPECT_EQ(d.search.final.chain().start, Start::equilibrium);
  EXPECT_EQ(d.search.initial.chain().start, std::nullopt);
  ASSERT_EQ(d.steps.size(), 1u);
  EXPECT_EQ(d.steps[0].effect, "saturation");
  EXPECT_EQ(d.scored_from[0].from_s, 0.0);
  EXPECT_LT(d.final.holdout_whole_rms, 0.006);
  const Json json = gap::to_json(d);
  EXPECT_EQ(json["start"]["chosen"], "equilibrium");
  EXPECT_NE(d.advice.find("begin under bias"), std::string::npos);
}

TEST(StartChoice, AStepFromRestInZeroStaysOne) {
  const auto d = diagnosed(model_of(kLag), lagging(waves(kBias, 2.0), 4.0, 9.0, 0.0, 3),
                           lagging(waves(kBias, 3.1), 4.0, 9.0, 0.0, 4));
  ASSERT_TRUE(d.start.has_value());
  EXPECT_EQ(d.start->chosen, Start::zero);
  EXPECT_FALSE(d.start->by_search);
  EXPECT_EQ(d.search.final.chain().start, std::nullopt);
  EXPECT_TRUE(d.steps.empty());
}

TEST(StartChoice, OfTwoWrongStartsTheFarNearerOneIsTaken) {
  const auto d = diagnosed(model_of(kLag), lagging(waves(kBias, 2.0), 4.0, 9.0, 0.75 * kBias, 11),
                           lagging(waves(kBias, 3.1), 4.0, 9.0, 0.75 * kBias, 12));
  ASSERT_TRUE(d.start.has_value());
  EXPECT_EQ(d.start->chosen, Start::equilibrium);
  EXPECT_LT(d.start->equilibrium_rms, 0.5 * d.start->zero_rms);
  EXPECT_GT(d.scored_from[0].from_s, 0.0);
  EXPECT_TRUE(d.steps.empty());
}

TEST(StartChoice, WhereTheBaseModelHasNoStatesItsTermsDecide) {
  const auto d = diagnosed(model_of(kGain), playing(waves(kBias, 2.0), 5), playing(waves(kBias, 3.1), 6));
  ASSERT_TRUE(d.start.has_value());
  EXPECT_EQ(d.start->chosen, Start::equilibrium);
  ASSERT_EQ(d.steps.size(), 1u);
  EXPECT_EQ(d.steps[0].effect, "backlash");
  EXPECT_LT(d.final.holdout_whole_rms, 0.006);
}

TEST(StartChoice, NothingIsChosenWhereTheModelSaysItOrTheRecordBeginsAtZero) {
  auto base = model_of(kLag);
  const auto begins_at_zero =
      diagnosed(base, lagging(waves(0.0, 2.0), 4.0, 9.0, 0.0, 7), lagging(waves(0.0, 3.1), 4.0, 9.0, 0.0, 8));
  EXPECT_FALSE(begins_at_zero.start.has_value());
  base.start = Start::equilibrium;
  const auto said = diagnosed(base, lagging(waves(kBias, 2.0), 4.0, 9.0, kBias, 9),
                              lagging(waves(kBias, 3.1), 4.0, 9.0, kBias, 10));
  EXPECT_FALSE(said.start.has_value());
  EXPECT_EQ(said.search.final.chain().start, Start::equilibrium);
  EXPECT_LT(said.final.holdout_whole_rms, 0.004);
}

// The lag's own state at the start explains all of it.
TEST(StartSearch, AStartInMotionIsNoName) {
  for (unsigned seed = 31; seed < 34; ++seed) {
    const auto d = diagnosed(model_of(kLag), lagging(waves(0.0, 2.0), 4.0, 9.0, 1.0, seed),
                             lagging(waves(0.0, 3.1), 4.0, 9.0, -0.6, seed + 10));
    EXPECT_TRUE(d.steps.empty()) << seed;
  }
}

}  // namespace
