// Where and at which frequencies effects are looked for.
#include <gtest/gtest.h>

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

constexpr double kStaircaseStep = 4.4e-3;
constexpr int kStaircaseSamples = 2400;

chain::Chain chain_of_a_line() {
  return model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\nfree = [\"gain\"]\n");
}

/// A staircase of long treads behind a lag of 199 Hz and a mode of 39 Hz, by steps of a fiftieth of a sample.
TimeRecord staircase(unsigned seed) {
  constexpr int kFiner = 50;
  constexpr int kTread = 150;
  const double h = kStaircaseStep / kFiner;
  const double lag = std::exp(-2.0 * std::numbers::pi * 199.0 * h);
  const double w = 2.0 * std::numbers::pi * 39.0;
  constexpr double kDamping = 0.03;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> level(-1.0, 1.0);
  TimeRecord r;
  r.file = "staircase.csv";
  r.step_s = kStaircaseStep;
  double u = 0.0;
  double slow = 0.0;
  double y = 0.0;
  double v = 0.0;
  for (int i = 0; i < kStaircaseSamples; ++i) {
    const double next = i == 0 || i % kTread != 20 ? u : level(random);
    for (int k = 0; k < kFiner && i > 0; ++k) {
      const double now = u + (next - u) * (k + 0.5) / kFiner;
      const double before = slow;
      slow = lag * slow + (1.0 - lag) * now;
      // Half a step of the speed, a step of the place, half a step of the speed.
      const double pull = w * w * (2.0 * 0.5 * (before + slow));
      v += 0.5 * h * (pull - w * w * y - 2.0 * kDamping * w * v);
      y += h * v;
      v += 0.5 * h * (pull - w * w * y - 2.0 * kDamping * w * v);
    }
    u = next;
    r.u.push_back(u);
    r.y.push_back(y + 0.01 * normal(random));
  }
  return r;
}

// Steps have their power far below what their edges tell.
TEST(BeyondBand, LagIsNoDelay) {
  const auto d =
      gap::diagnose(chain_of_a_line(), gap::Study::of({staircase(1)}, {staircase(2)}, chain_of_a_line()), {});
  ASSERT_EQ(d.steps.size(), 2U);
  EXPECT_EQ(d.steps[0].effect, "resonance");
  EXPECT_EQ(d.steps[1].effect, "amplifier_pole");
  EXPECT_LT(d.final.train_rms, 0.0103);
}

}  // namespace
