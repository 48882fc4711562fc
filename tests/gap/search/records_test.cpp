// A branch that switches between two samples in front of something fast: what the engine takes for that is nobody's effect.
#include "gap/search/records.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"
#include "numeric/random.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith {
namespace {

std::string stage(double corner_hz) {
  return "[[block]]\ntype = \"lowpass\"\nfree = [\"corner_hz\"]\ncorner_hz = " + std::to_string(corner_hz) +
         "\n[[block]]\ntype = \"polynomial_hysteresis\"\nascending = [0.3546, -0.6433, 0.2887]\n"
         "descending = [-0.2398, 0.0838, 0.156]\nminor = \"slope_sign\"\n"
         "[[block]]\ntype = \"resonator\"\nnatural_frequency_hz = 65100.0\ndamping_ratio = 0.1206\n";
}

/// Three periods of a full-stroke triangle of 300 samples each, by CVODE, which finds the turns.
TimeRecord triangle(double hz, double noise, std::uint64_t seed) {
  constexpr int kPeriod = 300;
  TimeRecord r;
  r.file = "triangle.csv";
  r.step_s = 1.0 / (hz * kPeriod);
  for (int i = 0; i <= 3 * kPeriod; ++i) {
    const double phase = static_cast<double>(i % kPeriod) / kPeriod;
    r.u.push_back(phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase);
  }
  simulate::Options options;
  options.engine = simulate::Engine::cvode;
  options.estimate_error = false;
  r.y = simulate::simulate(model_of(stage(2000.0)), r, options).y;
  Random random(seed);
  for (double& y : r.y) y += noise * random.normal();
  return r;
}

TEST(RecordsOfASearch, TheEnginesOwnErrorIsNoEffect) {
  const chain::Chain base = model_of(stage(2100.0));
  const auto study =
      gap::Study::of(std::vector<TimeRecord>{triangle(100.0, 2e-5, 1)}, {triangle(60.0, 2e-5, 2)}, base);
  EXPECT_GT(gap::enough_holds(gap::Model(model_of(stage(2000.0))), study.train()), 1u);
  const gap::Diagnosis d = gap::diagnose(base, study, {});
  EXPECT_EQ(d.verdict, gap::Verdict::nothing_missing);
  for (const gap::DiagnosedStep& step : d.steps) ADD_FAILURE() << step.effect;
  EXPECT_NEAR(d.refitted.train_rms, 2e-5, 2e-6);
}

TEST(RecordsOfASearch, OneHoldIsEnoughWhereNothingJumps) {
  const chain::Chain base = model_of("[[block]]\ntype = \"lowpass\"\ncorner_hz = 2000.0\n");
  const auto study =
      gap::Study::of(std::vector<TimeRecord>{triangle(100.0, 2e-5, 1)}, {triangle(60.0, 2e-5, 2)}, base);
  EXPECT_EQ(gap::enough_holds(gap::Model(base), study.train()), 1u);
}

}  // namespace
}  // namespace bodesmith
