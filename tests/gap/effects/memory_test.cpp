// Of records that run along one loop again and again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"

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

TEST(OneLoop, IsNoGroundForAsymmetry) {
  const auto d = gap::diagnose(line(), gap::Study::of({loops(0.0, 1)}, {loops(0.6, 2)}, line()), {});
  ASSERT_FALSE(d.steps.empty());
  for (const auto& step : d.steps) EXPECT_NE(step.effect, "asymmetric_hysteresis");
}

}  // namespace
