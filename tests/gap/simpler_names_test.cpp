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

#include "base/document.hpp"
#include "chain/model_file.hpp"
#include "gap/diagnosis.hpp"

namespace {

using namespace bodesmith;

constexpr double kNoise = 0.004;
constexpr double kOffset = -0.6;

chain::Chain curve() {
  return chain::model_from_node(parse_toml(
      "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, 0.37]\n"
      "[[block]]\ntype = \"gain\"\ngain = 1.4\nfree = [\"gain\"]\n",
      "model.toml"));
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

/// The curve, and behind it one-sided (or plain) operators of memory beside the way through, and a constant.
TimeRecord record_of(unsigned seed, bool one_sided, double offset) {
  constexpr std::array kRadius = {0.12, 0.35, 0.6, 0.9};
  constexpr std::array kWeight = {0.05, 0.06, 0.05, 0.06};
  constexpr std::array kThreshold = {0.3, -0.25, 0.5, 0.1};
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "loops.csv";
  r.step_s = 1e-3;
  r.u = triangles(random, 700, 50 + 15 * static_cast<int>(seed));
  std::array<double, 4> play{};
  for (double u : r.u) {
    const double v = 1.5 * (u + 0.37 * u * u);
    double y = v + offset;
    for (std::size_t k = 0; k < play.size(); ++k) {
      play[k] = std::clamp(play[k], v - kRadius[k], v + kRadius[k]);
      y += kWeight[k] * (one_sided ? std::max(play[k] - kThreshold[k], 0.0) : play[k]);
    }
    r.y.push_back(y + kNoise * normal(random));
  }
  return r;
}

std::set<std::string> names_in(const std::vector<TimeRecord>& train, const TimeRecord& holdout) {
  const auto base = curve();
  const auto d = gap::diagnose(base, gap::Study::of(train, {holdout}, base), {});
  std::set<std::string> names;
  for (const auto& step : d.steps) names.insert(step.effect);
  return names;
}

TEST(SimplerNames, symmetricMemoryAndAnOffsetAreNotAsymmetricMemory) {
  const auto record = [](unsigned seed) { return record_of(seed, false, kOffset); };
  EXPECT_EQ(names_in({record(1), record(2)}, record(3)), (std::set<std::string>{"hysteresis", "offset"}));
}

TEST(SimplerNames, leaveAsymmetricMemoryItsName) {
  const auto record = [](unsigned seed) { return record_of(seed, true, 0.0); };
  EXPECT_EQ(names_in({record(1)}, record(3)), (std::set<std::string>{"asymmetric_hysteresis"}));
}

}  // namespace
