// Of records that run along one loop again and again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/scene.hpp"

namespace {

using namespace bodesmith;

/// A sine whose size changes by `growth` from the first period to the last; a loop whose branches differ (a play of a
/// curve), and noise.
TimeRecord loops(double growth, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "loops.csv";
  r.step_s = 1e-2;
  double play = 0.0;
  for (int i = 0; i < 500; ++i) {
    const double t = i * r.step_s;
    const double u = (1.0 - growth * (1.0 - t / 5.0)) * std::sin(2.0 * std::numbers::pi * t);
    const double curve = u + 0.5 * u * u;
    play = std::clamp(play, curve - 0.2, curve + 0.2);
    r.u.push_back(u);
    r.y.push_back(u + 0.4 * (play - curve) + 0.004 * normal(random));
  }
  return r;
}

chain::Chain line() {
  return model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\noffset = 0.0\nfree = [\"gain\", \"offset\"]\n");
}

/// The sine through `at` of a sample's time and input, and noise.
template <class Curve>
TimeRecord of_sine(const Curve& at) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  TimeRecord r = loops(0.0, 5);
  for (std::size_t i = 0; i < r.size(); ++i)
    r.y[i] = at(static_cast<double>(i) * r.step_s, r.u[i]) + 0.004 * normal(random);
  return r;
}

bool names(const gap::Diagnosis& d, std::string_view effect) {
  return std::any_of(d.steps.begin(), d.steps.end(), [&](const auto& step) { return step.effect == effect; });
}

TEST(OneLoop, ALimitNextToALagIsANameWhereNothingIsLeft) {
  const auto clipped = of_sine([](double t, double) {
    return std::min(0.85, std::sin(2.0 * std::numbers::pi * std::max(0.0, t - 0.03)));
  });
  const auto d = gap::diagnose(line(), gap::Study::of({clipped}, {}, line()), {});
  EXPECT_EQ(d.steps.size(), 2U);
  EXPECT_TRUE(names(d, "saturation"));
}

TEST(OneLoop, ABentLoopIsNoLimit) {
  // Half as steep in its upper part: a limit behind a lag would take two thirds of what the lag leaves.
  const auto bent = of_sine([](double t, double) {
    const double late = std::sin(2.0 * std::numbers::pi * std::max(0.0, t - 0.03));
    return std::min(late, 0.25 + 0.5 * late);
  });
  gap::SearchOptions options;
  options.max_terms = 2;
  const auto d = gap::diagnose(line(), gap::Study::of({bent}, {}, line()), options);
  EXPECT_FALSE(names(d, "saturation"));
}

/// Straight ways from one value to the next, a hundredth of the stroke a sample.
TimeRecord by_ways(const std::vector<double>& ends) {
  TimeRecord r;
  r.file = "ways.csv";
  r.step_s = 1e-2;
  r.u = {ends.front()};
  for (std::size_t i = 1; i < ends.size(); ++i) {
    const int count = static_cast<int>(std::lround(std::abs(ends[i] - ends[i - 1]) / 0.01));
    for (int k = 1; k <= count; ++k) r.u.push_back(ends[i - 1] + (ends[i] - ends[i - 1]) * k / count);
  }
  r.y = r.u;
  return r;
}

bool may_be_asymmetric(const std::vector<TimeRecord>& train) {
  const chain::Chain base = line();
  const auto study = gap::Study::of(train, {train.front()}, base);
  std::vector<gap::Proposal> proposals;
  gap::effect_registry()
      .get("asymmetric_hysteresis")
      .propose(gap::make_scene(gap::Model(base), study.train()), proposals);
  return !proposals.empty();
}

// A loop within the loop is one that is wider than what a name must explain: .15 of the stroke.
TEST(OneLoop, IsOneThatTurnsNowhereElse) {
  using Ends = std::vector<double>;
  const auto is_one = [](const Ends& ends) { return !may_be_asymmetric({by_ways(ends)}); };
  EXPECT_TRUE(is_one({0, 1, 0, 1, 0, 1}));
  // On the way in it may turn twice anywhere, but no third time.
  EXPECT_TRUE(is_one({0.5, 0.75, 0, 1, 0, 1}));
  EXPECT_TRUE(is_one({0.5, 0.75, 0.25, 1, 0, 1}));
  EXPECT_FALSE(is_one({0.5, 0.75, 0.25, 0.7, 0, 1, 0}));
  EXPECT_FALSE(is_one({0, 1, 0, 0.5, 0, 1}));
  EXPECT_FALSE(is_one({0, 1, 0, 1, 0.5, 1, 0}));
  // Short of the end it turns as at the end.
  EXPECT_TRUE(is_one({0, 1, 0, 0.87, 0, 1, 0.13, 1}));
  EXPECT_FALSE(is_one({0, 1, 0, 0.83, 0, 1}));
  EXPECT_FALSE(is_one({0, 1, 0, 1, 0.17, 1}));
  // Back and forth on its way it may go as little.
  EXPECT_TRUE(is_one({0, 1, 0, 0.6, 0.47, 1, 0}));
  EXPECT_FALSE(is_one({0, 1, 0, 0.6, 0.43, 1, 0}));
}

TEST(OneLoop, IsOfOneRecord) {
  const TimeRecord loop = by_ways({0, 1, 0, 1, 0, 1});
  EXPECT_FALSE(may_be_asymmetric({loop}));
  EXPECT_TRUE(may_be_asymmetric({loop, loop}));
}

TEST(OneLoop, IsNoGroundForAsymmetry) {
  const auto d = gap::diagnose(line(), gap::Study::of({loops(0.0, 1)}, {loops(0.6, 2)}, line()), {});
  ASSERT_FALSE(d.steps.empty());
  for (const auto& step : d.steps) EXPECT_NE(step.effect, "asymmetric_hysteresis");
}

}  // namespace
