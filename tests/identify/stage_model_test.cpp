#include "identify/stage_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "hysteresis/registry.hpp"
#include "identify/compensation.hpp"
#include "identify/stage_fit.hpp"

namespace bodesmith::identify {
namespace {

using chain::make_block;

constexpr const char* kHead = "schema = \"bodesmith.model/1\"\n";

StageModel parse(const std::string& text) {
  return StageModel::of(chain::model_from_node(parse_toml(kHead + text, "model.toml")), "model.toml");
}

TEST(StageModel, GainsBeforeAndBehindTheModelAreComposed) {
  const StageModel stage = parse(
      "[[block]]\ntype = \"gain\"\ngain = 2.0\noffset = 1.0\n[[block]]\ntype = \"gain\"\ngain = 3.0\n"
      "[[block]]\ntype = \"bouc_wen\"\nk = 1.0\nA = 0.5\nbeta = 1.3\ngamma = 0.9\n"
      "[[block]]\ntype = \"delay\"\ndelay_s = 0.25\n"
      "[[block]]\ntype = \"gain\"\ngain = 5.0\noffset = -1.0\n");
  EXPECT_EQ(stage.input.gain, 6.0);
  EXPECT_EQ(stage.input.offset, 3.0);
  EXPECT_EQ(stage.output.gain, 5.0);
  EXPECT_EQ(stage.output.offset, -1.0);
  EXPECT_EQ(stage.delay_s, 0.25);
  ASSERT_NE(stage.model.type, nullptr);
  EXPECT_EQ(stage.model.type->name(), "bouc_wen");
  // As a chain: gain, model, gain, delay, the last two free.
  chain::Chain chain = stage.chain();
  ASSERT_EQ(chain.blocks.size(), 4u);
  EXPECT_EQ(chain.free_parameters().size(), 3u);
}

TEST(StageModel, RefusesWhatItCannotInvertAtItsLine) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parse(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string lag = refusal("[[block]]\ntype = \"lowpass\"\ncorner_hz = 1.0\n");
  EXPECT_EQ(lag.substr(0, 13), "model.toml:2:") << lag;
  EXPECT_NE(lag.find("'lowpass'"), std::string::npos) << lag;
  const std::string play = "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0]\nw = [1.0]\n";
  EXPECT_NE(refusal(play + play).find("second hysteresis model"), std::string::npos);
  EXPECT_NE(refusal("block = []\n").find("expected at least one"), std::string::npos);
}

TEST(StageModel, DelayedIsLinearBetweenSamplesAndHeldBefore) {
  EXPECT_EQ(delayed({1.0, 3.0, 5.0}, 1.0, 0.5), (std::vector<double>{1.0, 2.0, 4.0}));
  EXPECT_EQ(delayed({1.0, 3.0, 5.0}, 1.0, -1.0), (std::vector<double>{3.0, 5.0, 5.0}));
}

TEST(Compensation, LooksAheadByTheDelayOrLagsByIt) {
  StageModel stage;
  stage.output = {2.0, 1.0};
  stage.delay_s = 0.003;
  std::vector<double> reference;
  for (int i = 0; i < 100; ++i) reference.push_back(0.1 * i);
  const Compensation ahead = compensate(stage, reference, 1e-3, true);
  for (std::size_t i = 3; i < 97; ++i) EXPECT_NEAR(ahead.predicted[i], reference[i], 1e-12) << i;
  const Compensation causal = compensate(stage, reference, 1e-3, false);
  for (std::size_t i = 3; i < 97; ++i) EXPECT_NEAR(causal.predicted[i], reference[i - 3], 1e-12) << i;
}

TEST(StageFit, FindsTheDelayOfALine) {
  TimeRecord record;
  record.file = "record";
  record.step_s = 1e-3;
  for (int i = 0; i < 2000; ++i) record.u.push_back(std::sin(0.05 * i));
  record.y = delayed(record.u, record.step_s, 2.5e-3);
  for (double& y : record.y) y = 3.0 * y - 1.0;
  StageFitOptions options;
  options.find_delay = true;
  options.identify.skip_s = 0.1;
  const StageFit fit = fit_stage(nullptr, {&record, 1}, {}, options);
  EXPECT_EQ(fit.model, "linear");
  EXPECT_NEAR(fit.stage.delay_s, 2.5e-3, 5e-5);
  EXPECT_NEAR(fit.stage.output.gain, 3.0, 5e-3);
}

TEST(ErrorFigures, AreThoseOfEquation8) {
  const ErrorFigures e = error_figures({1.0, 2.0, 4.0}, {0.0, 2.0, 4.0});
  EXPECT_DOUBLE_EQ(e.rms, std::sqrt(1.0 / 3.0));
  EXPECT_DOUBLE_EQ(e.max, 1.0);
  EXPECT_DOUBLE_EQ(e.range, 4.0);
  EXPECT_DOUBLE_EQ(e.rms_percent, 25.0 * e.rms);
  EXPECT_NEAR(e.rms_free_offset, std::sqrt(2.0 / 9.0), 1e-15);
}

}  // namespace
}  // namespace bodesmith::identify
