// Drag that outweighs a resonator's own damping a hundred times: the free damping ratio takes over what it can of it, and the mode
// is found far from where it was given. Drag is looked for in decades, up to what holds the spring.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/made_record.hpp"

namespace bodesmith {
namespace {

constexpr double kStep_s = 1.2e-3;
constexpr int kSamples = 500;
constexpr double kNoise = 0.001;

/// Twelve sines of drawn phases up to `to_hz`.
std::vector<double> multisine(unsigned seed, double to_hz) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
  std::vector<double> u(kSamples, 0.0);
  for (int k = 1; k <= 12; ++k) {
    const double phase = turn(random);
    for (int i = 0; i < kSamples; ++i)
      u[static_cast<std::size_t>(i)] +=
          0.2 * (std::sin(2.0 * std::numbers::pi * to_hz * k / 12.0 * kStep_s * i + phase) - std::sin(phase));
  }
  return u;
}

TEST(Drag, IsNamedWhereItOutweighsTheDampingAHundredTimes) {
  const std::string gain = "[[block]]\ntype = \"gain\"\ngain = 1.15\nfree = [\"gain\"]\n";
  const std::string truth =
      gain +
      "[[block]]\ntype = \"lowpass\"\ncorner_hz = 55.0\n[[block]]\ntype = \"resonator\"\n"
      "gain = 1.0\nnatural_frequency_hz = 65.0\ndamping_ratio = 0.06\ndrag = 0.35\n";
  const auto base = model_of(
      gain +
      "[[block]]\ntype = \"lowpass\"\ncorner_hz = 57.0\nfree = [\"corner_hz\"]\n[[block]]\ntype = \"resonator\"\ngain = 1.0\n"
      "natural_frequency_hz = 65.0\ndamping_ratio = 0.0625\nfree = [\"natural_frequency_hz\", \"damping_ratio\"]\n");
  std::vector<TimeRecord> train = {measured(truth, multisine(1, 20.0), kStep_s, kNoise, 11),
                                   measured(truth, multisine(2, 8.0), kStep_s, kNoise, 12)};
  const auto d = gap::diagnose(
      base,
      gap::Study::of(std::move(train), {measured(truth, multisine(3, 14.0), kStep_s, kNoise, 13)}, base), {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "drag");
  EXPECT_NEAR(d.steps[0].parameters[0].value, 0.35, 0.05);
  EXPECT_LT(d.final.train_rms, 1.1 * kNoise);
}

}  // namespace
}  // namespace bodesmith
