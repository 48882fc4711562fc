// A fit that got stuck at one place of a linear effect begins again with the values found at another; one begins where least is left; edges
// that stand on samples do not keep other unknowns from moving.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>

#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"

namespace {

using namespace bodesmith;

constexpr double kLooseStep = 7.7e-3;
constexpr double kLooseHz = 4.2;

chain::Chain stage_with_loops() {
  return model_of(
      "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0, 0.1, 0.4]\nw = [1.0, 0.06, 0.1]\n"
      "[[block]]\ntype = \"gain\"\ngain = 15.0\nfree = [\"gain\"]\n"
      "[[block]]\ntype = \"resonator\"\ngain = 1.0\nnatural_frequency_hz = 11.2\ndamping_ratio = 0.0125\n"
      "free = [\"natural_frequency_hz\", \"damping_ratio\"]\n");
}

struct Mode {
  double natural_hz;
  double damping;
  double y = 0.0;
  double v = 0.0;
  double step(double u, double h) {
    const double w = 2.0 * std::numbers::pi * natural_hz;
    v += 0.5 * h * (w * w * (u - y) - 2.0 * damping * w * v);
    y += h * v;
    v += 0.5 * h * (w * w * (u - y) - 2.0 * damping * w * v);
    return y;
  }
};

/// Treads of a staircase through two plays, a loose part of 4.2 Hz and the stage's own mode.
TimeRecord shaken(unsigned seed) {
  constexpr int kFiner = 50;
  constexpr int kTread = 100;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> level(-1.0, 1.0);
  TimeRecord r;
  r.file = "shaken.csv";
  r.step_s = kLooseStep;
  Mode loose{kLooseHz, 0.02};
  Mode own{11.4, 0.0121};
  double u = 0.0;
  double small = 0.0;
  double large = 0.0;
  double y = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double next = i % kTread == 20 ? level(random) : u;
    for (int k = 0; k < kFiner && i > 0; ++k) {
      const double now = u + (next - u) * (k + 0.5) / kFiner;
      small = std::clamp(small, now - 0.1, now + 0.1);
      large = std::clamp(large, now - 0.4, now + 0.4);
      const double h = kLooseStep / kFiner;
      y = own.step(loose.step(15.9 * (now + 0.06 * small + 0.1 * large), h), h);
    }
    u = next;
    r.u.push_back(u);
    r.y.push_back(y + 0.1 * normal(random));
  }
  return r;
}

TEST(SharedValues, FindTheSharpModeBehindTheLoops) {
  const auto base = stage_with_loops();
  const auto d = gap::diagnose(base, gap::Study::of({shaken(1)}, {shaken(2)}, base), {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "resonance");
  EXPECT_EQ(d.steps[0].placed, "after block 3");
  EXPECT_LT(d.final.train_rms, 0.11);
}

struct HiddenInRecord {
  const char* name;
  const char* base;
  const char* truth;
  double noise;
  std::set<std::string> names;
};

class OftenStuck : public testing::TestWithParam<HiddenInRecord> {};
TEST_P(OftenStuck, IsNamedAndNothingElse) {
  const auto& hidden = GetParam();
  const auto base = model_of(hidden.base);
  const auto record = [&](double size, double hz, unsigned seed) {
    return measured(hidden.truth, two_sines(700, size, hz), 1e-3, hidden.noise, seed);
  };
  const auto d = gap::diagnose(
      base, gap::Study::of({record(1.0, 11.0, 1), record(0.7, 5.3, 2)}, {record(0.9, 8.1, 3)}, base), {});
  std::set<std::string> names;
  for (const auto& step : d.steps) names.insert(step.effect);
  EXPECT_EQ(names, hidden.names);
  EXPECT_LT(d.final.holdout_rms, 1.2 * hidden.noise);
}
const char* const kFreeGain = "[[block]]\ntype = \"gain\"\ngain = 1.6\nfree = [\"gain\"]\n";
const char* const kFreeGainAndPole =
    "[[block]]\ntype = \"gain\"\ngain = 1.6\nfree = [\"gain\"]\n"
    "[[block]]\ntype = \"lowpass\"\ncorner_hz = 40.0\nfree = [\"corner_hz\"]\n";
INSTANTIATE_TEST_SUITE_P(
    Records, OftenStuck,
    testing::Values(
        // Every edge of the clock stands on a sample.
        HiddenInRecord{"curve_behind_a_hold",
                       kFreeGain,
                       "[[block]]\ntype = \"sample_hold\"\nclock_hz = 111.11111111111111\n"
                       "[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.5, 0.2]\n",
                       0.02,
                       {"sample_hold", "quadratic_nonlinearity"}},
        HiddenInRecord{
            "clock_faster_than_a_short_record",
            kFreeGainAndPole,
            "[[block]]\ntype = \"sample_hold\"\nclock_hz = 1086.0\n[[block]]\ntype = \"gain\"\ngain = 1.5\n"
            "[[block]]\ntype = \"lowpass\"\ncorner_hz = 41.0\n",
            1e-4,
            {"sample_hold"}},
        // With the lag's work done by the resonator's own free values, a mode would take the resonator's place.
        HiddenInRecord{"lag_in_front_of_a_free_resonator",
                       "[[block]]\ntype = \"resonator\"\ngain = 1.0\nnatural_frequency_hz = 30.2\n"
                       "damping_ratio = 0.19\nfree = [\"natural_frequency_hz\", \"damping_ratio\"]\n",
                       "[[block]]\ntype = \"lowpass\"\ncorner_hz = 19.0\n"
                       "[[block]]\ntype = \"resonator\"\ngain = 1.0\nnatural_frequency_hz = 30.0\n"
                       "damping_ratio = 0.18\n",
                       5e-5,
                       {"amplifier_pole"}},
        // Neither radius is one of the bank's.
        HiddenInRecord{
            "two_plays",
            kFreeGain,
            "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0, 0.033, 0.071]\nw = [1.5, 0.4, 0.5]\n",
            0.001,
            {"hysteresis"}}),
    [](const auto& hidden) { return hidden.param.name; });

}  // namespace
