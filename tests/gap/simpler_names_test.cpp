// Asymmetric memory has a constant of its own and many unknowns: it explains alone what symmetric memory and an offset
// did. It is tried against its simpler relatives with one more name beside them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"

namespace {

using namespace bodesmith;

constexpr double kNoise = 0.004;
constexpr double kOffset = -0.6;

chain::Chain curve() {
  return model_of(
      "[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, 0.37]\n"
      "[[block]]\ntype = \"gain\"\ngain = 1.4\nfree = [\"gain\"]\n");
}

/// Triangles whose heights are drawn.
std::vector<double> triangles(std::mt19937_64& random, int samples, int half_period) {
  std::uniform_real_distribution<double> height(0.25, 1.0);
  std::vector<double> u;
  double from = 0.0;
  double to = 1.0;
  for (int i = 0; i < samples; ++i) {
    const int k = i % half_period;
    if (k == 0 && i > 0) {
      from = to;
      to = (to > 0.0 ? -1.0 : 1.0) * height(random);
    }
    u.push_back(from + (to - from) * k / half_period);
  }
  return u;
}

/// The curve, and behind it plays beside the way through, and a constant.
TimeRecord record_of(unsigned seed) {
  constexpr std::array kRadius = {0.12, 0.35, 0.6, 0.9};
  constexpr std::array kWeight = {0.05, 0.06, 0.05, 0.06};
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "loops.csv";
  r.step_s = 1e-3;
  r.u = triangles(random, 700, 50 + 15 * static_cast<int>(seed));
  std::array<double, 4> play{};
  for (double u : r.u) {
    const double v = 1.5 * (u + 0.37 * u * u);
    double y = v + kOffset;
    for (std::size_t k = 0; k < play.size(); ++k) {
      play[k] = std::clamp(play[k], v - kRadius[k], v + kRadius[k]);
      y += kWeight[k] * play[k];
    }
    r.y.push_back(y + kNoise * normal(random));
  }
  return r;
}

TEST(SimplerNames, symmetricMemoryAndAnOffsetAreNotAsymmetricMemory) {
  const auto base = curve();
  const auto d = gap::diagnose(base, gap::Study::of({record_of(1), record_of(2)}, {record_of(3)}, base), {});
  std::set<std::string> names;
  for (const auto& step : d.steps) names.insert(step.effect);
  EXPECT_EQ(names, (std::set<std::string>{"hysteresis", "offset"}));
  EXPECT_LT(d.final.train_rms, 1.1 * kNoise);
}

}  // namespace
