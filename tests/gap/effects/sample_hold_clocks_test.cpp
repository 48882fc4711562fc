// The lag and the clock of a hold, found in a residual that was made with both known.
#include "gap/effects/sample_hold_clocks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "gap/made_model.hpp"
#include "gap/made_record.hpp"

namespace hold_clocks {
namespace {

using namespace bodesmith;

/// A scene of a model that does nothing and measures x, later by `lag` samples.
struct Late {
  gap::Model model{model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\n")};
  gap::Scene scene;
  explicit Late(double lag, double noise = 0.0) {
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal;
    const auto x = [](double t) { return std::sin(0.05 * t) + 0.4 * std::cos(0.013 * t + 1.0); };
    scene.model = &model;
    scene.step_s = 1e-3;
    scene.band_hz = 8.0;
    scene.boundary.resize(2);
    for (int i = 0; i < 3000; ++i) {
      scene.boundary.back().values.push_back(x(i));
      scene.residual.push_back(x(i - lag) - x(i) + noise * normal(random));
    }
  }
};

TEST(HoldLag, IsThatOfTheOutputOverTheModels) {
  for (const double lag : {0.2, 1.0, 2.0, 5.0, 17.0})
    EXPECT_NEAR(gap::mean_lag_s(Late(lag).scene), 1e-3 * lag, 1e-6 * lag + 1e-8) << lag;
  // An output that comes early has none.
  EXPECT_EQ(gap::mean_lag_s(Late(-3.0).scene), 0.0);
  EXPECT_EQ(gap::mean_lag_s(Late(-0.3).scene), 0.0);
  EXPECT_NEAR(gap::mean_lag_s(Late(9.0, 0.05).scene), 9e-3, 1.1e-3);
}

constexpr double kClockHz = 41.7;

std::string hold(bool half) {
  return "[[block]]\ntype = \"sample_hold\"\nclock_hz = 41.7\nhalf_cycle = " +
         std::string(half ? "true\n" : "false\n");
}

const std::string kInFront = "[[block]]\ntype = \"gain\"\ngain = 2.0\n";
/// Linear dynamics, and a constant, behind the hold.
const std::string kBehind =
    "[[block]]\ntype = \"lowpass\"\ncorner_hz = 30.0\n[[block]]\ntype = \"gain\"\ngain = -1.5\noffset = 0.7\n";

std::string delay(bool half) {
  return "[[block]]\ntype = \"delay\"\ndelay_s = " + std::to_string((half ? 1.0 : 0.5) / kClockHz) + "\n";
}

TEST(HoldClock, IsFoundInItsStairs) {
  const auto u = two_sines(3000, 1.0, 0.8);
  for (const std::string& behind : {std::string(), kBehind}) {
    const gap::Model model(model_of(kInFront + behind));
    for (const bool half : {false, true}) {
      TimeRecord record = measured(kInFront + hold(half) + behind, u, 1e-3, 1e-3, 3);
      auto scene = gap::make_scene(model, {gap::TimeExperiment(record)});
      const auto first = [&](double guess) { return gap::clocks_of_hold(scene, 1, half, guess).at(0).at(0); };
      // A tenth of the record's resolution.
      EXPECT_NEAR(first(50.0), kClockHz, 0.03) << half << behind;
      EXPECT_NEAR(first(33.0), kClockHz, 0.03) << half << behind;
      // The stairs alone, when other parts of the model have taken the mean lag over.
      const TimeRecord lagging = measured(kInFront + delay(half) + behind, u, 1e-3, 0.0, 3);
      for (std::size_t i = 0; i < u.size(); ++i) scene.residual[i] = record.y[i] - lagging.y[i];
      EXPECT_NEAR(first(0.0), kClockHz, 0.03) << half << behind;
    }
  }
}

// Of those of less than four samples a cycle one transform tells all.
TEST(HoldClock, FastOnesAreFoundInNoiseTooAndBetweenSamples) {
  const gap::Model model(model_of(kInFront));
  std::vector<double> u(1000);
  for (std::size_t i = 0; i < u.size(); ++i)
    u[i] = std::sin(0.13 * double(i)) + 0.5 * std::sin(0.41 * double(i));
  for (const double clock_hz : {273.0, 391.7, 610.3, 1187.0}) {
    for (const bool half : {false, true}) {
      const auto behind = [&](const std::string& block) {
        return measured(kInFront + "[[block]]\n" + block, u, 1e-3, 0.02, 3);
      };
      const auto record = behind("type = \"sample_hold\"\nclock_hz = " + std::to_string(clock_hz) +
                                 "\nhalf_cycle = " + (half ? "true\n" : "false\n"));
      const auto lagging =
          behind("type = \"delay\"\ndelay_s = " + std::to_string((half ? 1.0 : 0.5) / clock_hz) + "\n");
      auto scene = gap::make_scene(model, {gap::TimeExperiment(record)});
      std::mt19937_64 random(7);
      std::normal_distribution<double> normal(0.0, 0.02);
      for (std::size_t i = 0; i < u.size(); ++i)
        scene.residual[i] = record.y[i] - lagging.y[i] + normal(random);
      EXPECT_NEAR(gap::clocks_of_hold(scene, 1, half).at(0).at(0), clock_hz, 0.1) << clock_hz << half;
    }
  }
}

// Looks of more samples refine what those of fewer found: the clocks that are kept are further apart than one peak is wide.
TEST(HoldClock, KeptOnesAreOfDifferentPeaks) {
  const gap::Model model(model_of(kInFront));
  const TimeRecord record = measured(kInFront + hold(false), two_sines(3000, 1.0, 0.8), 1e-3, 0.01, 3);
  const auto starts = gap::clocks_of_hold(gap::make_scene(model, {gap::TimeExperiment(record)}), 1, false);
  ASSERT_GT(starts.size(), 1U);
  ASSERT_LE(starts.size(), 8U);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) EXPECT_GT(std::abs(starts[i][0] - starts[k][0]), 0.2);
  }
}

}  // namespace
}  // namespace hold_clocks
