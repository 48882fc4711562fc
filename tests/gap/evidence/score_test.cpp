// A constant and a drift under noise that is slow itself: named where likelihood tells them from it.
#include <gtest/gtest.h>

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

constexpr int kSlowRows = 2000;
constexpr double kSlowStep_s = 1e-3;
constexpr double kSlowNoise = 0.02;

/// A gain of 2 with noise that forgets itself in 100 samples, and this much of a constant and of a drift over the record.
TimeRecord under_slow_noise(std::mt19937_64& random, double constant, double drift) {
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = kSlowStep_s;
  const double phase = normal(random);
  double slow = normal(random);
  for (int i = 0; i < kSlowRows; ++i) {
    const double t = i * kSlowStep_s;
    r.u.push_back(std::sin(2.0 * std::numbers::pi * 7.0 * t + phase) +
                  0.5 * std::sin(2.0 * std::numbers::pi * 23.0 * t));
    r.y.push_back(2.0 * r.u.back() + kSlowNoise * slow + constant + drift * i / kSlowRows);
    slow = 0.99 * slow + std::sqrt(1.0 - 0.99 * 0.99) * normal(random);
  }
  return r;
}

std::set<std::string> named_under_slow_noise(std::uint64_t seed, double constant, double drift) {
  std::mt19937_64 random(seed);
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\nfree = [\"gain\"]\n");
  std::vector<TimeRecord> train = {under_slow_noise(random, constant, drift)};
  const auto d = gap::diagnose(
      base, gap::Study::of(std::move(train), {under_slow_noise(random, constant, drift)}, base), {});
  std::set<std::string> names;
  for (const auto& step : d.steps) names.insert(step.effect);
  return names;
}

class RedNoiseOver : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RedNoiseOver, AConstantOfFiveTimesIsNamed) {
  EXPECT_EQ(named_under_slow_noise(GetParam(), 5.0 * kSlowNoise, 0.0), (std::set<std::string>{"offset"}));
}

TEST_P(RedNoiseOver, ADriftOfTenTimesIsNamed) {
  EXPECT_EQ(named_under_slow_noise(GetParam(), 0.0, 20.0 * kSlowNoise), (std::set<std::string>{"drift"}));
}

TEST_P(RedNoiseOver, NothingIsNamed) {
  EXPECT_TRUE(named_under_slow_noise(GetParam(), 0.0, 0.0).empty());
}

INSTANTIATE_TEST_SUITE_P(Drawn, RedNoiseOver, testing::Range<std::uint64_t>(1, 4));

}  // namespace
