// Where a constant enters a chain shows in how a record from rest begins; and a constant is no loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/scene.hpp"

namespace {

using namespace bodesmith;

constexpr double kOffsetStep = 1e-3;
constexpr double kFirstHz = 20.0;
constexpr double kSecondHz = 1.5;

chain::Chain two_lags(const std::string& start) {
  return model_of(
      start +
      "[[block]]\ntype = \"lowpass\"\ncorner_hz = 20.0\n[[block]]\ntype = \"lowpass\"\ncorner_hz = 1.5\n");
}

/// Two lags with `offset` between them, from rest, by steps of a hundredth of a sample.
TimeRecord two_tones(double offset, double noise, unsigned seed) {
  constexpr int kFiner = 100;
  const double h = kOffsetStep / kFiner;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "tones.csv";
  r.step_s = kOffsetStep;
  double first = 0.0;
  double second = 0.0;
  for (int i = 0; i < 2500; ++i) {
    const auto u = [](double t) {
      return 0.6 * std::sin(2.0 * std::numbers::pi * 3.0 * t) +
             0.4 * std::sin(2.0 * std::numbers::pi * 17.0 * t);
    };
    for (int k = 0; k < kFiner && i > 0; ++k) {
      const double part = (k + 0.5) / kFiner;
      const double now = u((i - 1) * kOffsetStep) * (1.0 - part) + u(i * kOffsetStep) * part;
      const double middle = first + 0.5 * h * 2.0 * std::numbers::pi * kFirstHz * (now - first);
      first += h * 2.0 * std::numbers::pi * kFirstHz * (now - middle);
      second += h * 2.0 * std::numbers::pi * kSecondHz * (middle + offset - second);
    }
    r.u.push_back(u(i * kOffsetStep));
    r.y.push_back(second + noise * normal(random));
  }
  return r;
}

TEST(OffsetPlace, IsSeenInTheStart) {
  const auto base = two_lags("");
  const auto d =
      gap::diagnose(base, gap::Study::of({two_tones(0.05, 0.005, 1)}, {two_tones(0.05, 0.005, 2)}, base), {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "offset");
  EXPECT_EQ(d.steps[0].placed, "before block 2");
  EXPECT_LT(d.final.train_rms, 0.0052);
}

std::vector<gap::Proposal> offsets_of(const chain::Chain& chain) {
  const gap::Model model(chain);
  gap::Experiments train;
  train.emplace_back(gap::TimeExperiment(two_tones(0.0, 0.0, 1)));
  std::vector<gap::Proposal> proposals;
  gap::effect_registry().get("offset").propose(gap::make_scene(model, train), proposals);
  return proposals;
}

TEST(OffsetPlace, IsOneInALinearStretchAtRest) {
  EXPECT_EQ(offsets_of(two_lags("")).size(), 3U);
  EXPECT_EQ(offsets_of(two_lags("start = \"equilibrium\"\n")).size(), 1U);
}

}  // namespace
