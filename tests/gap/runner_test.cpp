// Fits share their runs among threads, and long records are looked through in blocks: the same comes of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"
#include "gap/model/model_fit.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "numeric/parallel_for.hpp"

namespace {

using namespace bodesmith;

chain::Chain resonator() {
  return model_of(
      "[[block]]\ntype = \"resonator\"\ngain = 1.8\n"
      "natural_frequency_hz = 30.0\ndamping_ratio = 0.1\ncubic = 0.2\n"
      "free = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\", \"cubic\"]\n");
}

/// Smoothed noise through a gain of 2, with a line.
gap::Experiments record(int samples, double step_s, double line_hz, double amplitude) {
  return {
      gap::TimeExperiment(of_smoothed_noise("record.csv", 5, samples, step_s, [&](int i, double x, double e) {
        return std::pair(
            x, 2.0 * x + amplitude * std::sin(2.0 * std::numbers::pi * line_hz * step_s * i + 0.4) + 0.3 * e);
      }))};
}

TEST(Threads, FitsComeToTheSameBitsOnAnyNumber) {
  const auto train = record(2500, 1e-3, 50.0, 0.0);
  const auto fitted = [&](int threads) {
    const ThreadAllowance allowance(threads);
    LeastSquaresOptions options;
    options.max_iterations = 6;
    return gap::fit(gap::Model(resonator()), train, options);
  };
  const auto one = fitted(1);
  const auto three = fitted(3);
  ASSERT_TRUE(one.usable());
  EXPECT_EQ(one.result.values, three.result.values);
  EXPECT_EQ(one.result.residuals, three.result.residuals);
  EXPECT_EQ(one.result.deviation, three.result.deviation);
}

TEST(Threads, RunnerGiveTheBitsOfOne) {
  const auto train = record(2000, 1e-3, 50.0, 0.0);
  const gap::Model model(resonator());
  gap::Runner runners(model, train);
  std::vector<std::vector<double>> got(12);
  const auto values = [&](std::size_t i) {
    auto v = model.values();
    v[i % v.size()] *= 1.0 + 0.01 * static_cast<double>(i);
    return v;
  };
  parallel_for(got.size(), 4, [&](std::size_t i) { ASSERT_TRUE(runners(values(i), got[i])); });
  for (std::size_t i = 0; i < got.size(); ++i) {
    gap::Runner alone(model, train);
    std::vector<double> expected;
    ASSERT_TRUE(alone(values(i), expected));
    EXPECT_EQ(got[i], expected) << i;
  }
}

TEST(LongRecords, ShowTheMainsWhereTheyAre) {
  const double hz = 150.21;
  const auto train = record(60000, 1.0 / 610.0, hz, 0.02);
  const gap::Model model(model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\n"));
  const auto scene = gap::make_scene(model, train);
  const auto all = gap::effect_registry().all();
  const auto hum = std::find_if(all.begin(), all.end(),
                                [](const gap::Effect* effect) { return effect->name() == "mains_hum"; });
  ASSERT_NE(hum, all.end());
  std::vector<gap::Proposal> proposals;
  (*hum)->propose(scene, proposals);
  ASSERT_FALSE(proposals.empty());
  EXPECT_NEAR(proposals.front().starts.front().front(), hz, 0.4 / scene.duration_s);
}

}  // namespace
