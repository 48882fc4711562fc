// Hum as it is: the grid off its nominal frequency, another size and phase in every record, folded by the
// sampling; and what model.toml says of it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "base/documents/document.hpp"
#include "chain/model_file.hpp"
#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"
#include "gap/scene.hpp"
#include "simulate/simulate.hpp"

namespace {

using namespace bodesmith;

struct HumOf {
  double hz = 50.0;
  double amplitude = 0.0;
  double phase = 0.0;
};

/// `drift`: over the whole record.
TimeRecord record_with_hum(const char* file, double step_s, const HumOf& hum, unsigned seed,
                           double drift = 0.0) {
  constexpr int kSamples = 1200;
  return of_smoothed_noise(file, seed, kSamples, step_s, [&](int i, double x, double e) {
    const double line = std::sin(2.0 * std::numbers::pi * hum.hz * step_s * i + hum.phase);
    return std::pair(x, 2.0 * x + hum.amplitude * line + drift * i / kSamples + 0.005 * e);
  });
}

chain::Chain gain_of_two() {
  return model_of("[[block]]\ntype = \"gain\"\ngain = 1.9\nfree = [\"gain\"]\n");
}

class MainsHum : public testing::TestWithParam<std::pair<double, double>> {};
TEST_P(MainsHum, IsNamedOffItsFrequencyWithEachRecordsOwnPhase) {
  const auto [hz, step_s] = GetParam();
  const auto study = gap::Study::of({record_with_hum("a.csv", step_s, {hz, 0.05, 0.4}, 1),
                                     record_with_hum("b.csv", step_s, {hz, 0.04, 2.9}, 2)},
                                    {record_with_hum("c.csv", step_s, {hz, 0.06, -1.7}, 3)}, gain_of_two());
  const auto d = gap::diagnose(gain_of_two(), study, {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "mains_hum");
  EXPECT_TRUE(d.steps[0].tied_with.empty());
  EXPECT_EQ(d.verdict, gap::Verdict::explained);
  EXPECT_GT(d.steps[0].probability, 0.9);
  EXPECT_LT(d.final.holdout_rms, 1.1 * 0.005);
  // model.toml has the line as the first held-out record has it, and its figure is found with it.
  const auto text = chain::model_text(d.search.final.chain());
  const auto written = chain::model_from_node(parse_toml(text, "model.toml"));
  EXPECT_NEAR(written.blocks.back().get("frequency_hz"), hz, 0.02);
  EXPECT_NEAR(written.blocks.back().get("amplitude"), 0.06, 0.002);
  const auto& record = std::get<gap::TimeExperiment>(study.holdout().front()).record();
  const auto y = simulate::simulate(written, record).y;
  double sum = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) sum += (y[i] - record.y[i]) * (y[i] - record.y[i]);
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(y.size())), d.final.holdout_rms, 1e-9);
}
// A grid that is slow, a fast harmonic, and one above half the sampling rate.
INSTANTIATE_TEST_SUITE_P(Gap, MainsHum,
                         testing::Values(std::pair{49.85, 1e-3}, std::pair{180.5, 8e-4},
                                         std::pair{60.1, 0.0103}),
                         [](const auto& test) { return "case_" + std::to_string(test.index); });

/// Of a drift six times as large the spectrum reaches over twelve cycles of a line. A line that is not seen passes for red noise, under
/// which the drift is nothing sure either.
TEST(MainsHumOnADrift, IsProposed) {
  constexpr double kStep = 2e-4;
  const auto study =
      gap::Study::of({record_with_hum("a.csv", kStep, {49.9, 0.05, 0.4}, 1, 0.3)},
                     {record_with_hum("b.csv", kStep, {49.9, 0.05, 2.9}, 2, 0.3)}, gain_of_two());
  const gap::Model model(gain_of_two());
  std::vector<gap::Proposal> proposals;
  gap::effect_registry().get("mains_hum").propose(gap::make_scene(model, study.train()), proposals);
  ASSERT_FALSE(proposals.empty());
  EXPECT_NEAR(proposals.front().starts.front().front(), 49.9, 0.5);
}

}  // namespace
