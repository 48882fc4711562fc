// Two effects of one size in a resonator that is refitted: neither earns its place alone, as the free parameters take over what
// they can of the other one's share. They are found when they are put in together.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"
#include "simulate/record/record_simulator.hpp"

namespace drag_and_delay {
namespace {

using namespace bodesmith;

constexpr double kStep_s = 4e-4;
constexpr int kSamples = 1100;
constexpr double kNoise = 0.005;

/// Three drawn sines that grow.
std::vector<double> sines(std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(0.3, 1.0);
  std::vector<double> amplitudes;
  std::vector<double> frequencies_hz;
  for (double times : {1.0, 1.5 + part(random), 0.3 * part(random)}) {
    frequencies_hz.push_back(26.0 * times);
    amplitudes.push_back(2.0 * part(random));
  }
  std::vector<double> u;
  for (int i = 0; i < kSamples; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < amplitudes.size(); ++k)
      sum += amplitudes[k] * std::sin(2.0 * std::numbers::pi * frequencies_hz[k] * kStep_s * i);
    u.push_back(sum * (0.3 + 0.7 * i / kSamples));
  }
  return u;
}

/// Triangles of drawn heights.
std::vector<double> triangles(std::mt19937_64& random) {
  constexpr int kHalf = 55;
  std::uniform_real_distribution<double> height(0.8, 3.2);
  std::vector<double> u;
  double from = 0.0;
  double to = 3.2;
  for (int i = 0; i < kSamples; ++i) {
    if (i % kHalf == 0 && i > 0) {
      from = to;
      to = (to > 0.0 ? -1.0 : 1.0) * height(random);
    }
    u.push_back(from + (to - from) * (i % kHalf) / kHalf);
  }
  return u;
}

TimeRecord measured(std::mt19937_64& random, std::vector<double> input) {
  const auto truth = model_of(
      "[[block]]\ntype = \"resonator\"\ngain = 1.0\nnatural_frequency_hz = 64.5\ndamping_ratio = 0.23\n"
      "drag = 3.56e-4\n[[block]]\ntype = \"delay\"\ndelay_s = 7.76e-4\n");
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = kStep_s;
  r.u = std::move(input);
  simulate::RecordSimulator simulator(truth, kStep_s);
  for (double y : simulator.run(r.u)) r.y.push_back(y + kNoise * normal(random));
  return r;
}

class PairsAtOnce : public testing::TestWithParam<unsigned> {};
TEST_P(PairsAtOnce, DragAndADelayAreBothNamed) {
  std::mt19937_64 random(GetParam());
  const auto base = model_of(
      "[[block]]\ntype = \"resonator\"\ngain = 1.07\nnatural_frequency_hz = 69.5\ndamping_ratio = 0.216\n"
      "free = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\"]\n");
  std::vector<TimeRecord> train = {measured(random, sines(random)), measured(random, triangles(random))};
  const auto d =
      gap::diagnose(base, gap::Study::of(std::move(train), {measured(random, sines(random))}, base), {});
  std::set<std::string> names;
  for (const auto& step : d.steps) names.insert(step.effect);
  EXPECT_EQ(names, (std::set<std::string>{"drag", "time_delay"}));
  EXPECT_LT(d.final.train_rms, 1.1 * kNoise);
}
INSTANTIATE_TEST_SUITE_P(Drawn, PairsAtOnce, testing::Values(1U));

}  // namespace
}  // namespace drag_and_delay
