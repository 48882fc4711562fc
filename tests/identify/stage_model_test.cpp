#include "identify/stage_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "hysteresis/model_type.hpp"
#include "identify/record_findings.hpp"
#include "identify/stage_fit.hpp"

namespace bodesmith::identify {
namespace {

using chain::make_block;

TEST(StageModel, DelayedIsLinearBetweenSamplesAndHeldBefore) {
  EXPECT_EQ(later_by({1.0, 3.0, 5.0}, 0.5), (std::vector<double>{1.0, 2.0, 4.0}));
  EXPECT_EQ(later_by({1.0, 3.0, 5.0}, -1.0), (std::vector<double>{3.0, 5.0, 5.0}));
}

TEST(StageFit, FindsTheDelayOfALine) {
  TimeRecord record;
  record.file = "record";
  record.step_s = 1e-3;
  for (int i = 0; i < 2000; ++i) record.u.push_back(std::sin(0.05 * i));
  record.y = later_by(record.u, 2.5e-3 / record.step_s);
  for (double& y : record.y) y = 3.0 * y - 1.0;
  StageFitOptions options;
  options.find_delay = true;
  options.identify.skip_s = 0.1;
  const StageFit fit = fit_stage(nullptr, {&record, 1}, {}, options);
  EXPECT_EQ(fit.model, "linear");
  EXPECT_NEAR(fit.stage.delay_s, 2.5e-3, 5e-5);
  EXPECT_NEAR(fit.stage.output.gain, 3.0, 5e-3);
}

TEST(StageFit, DelaysUpToEightSamplesAndNoneAreFound) {
  TimeRecord record;
  record.file = "record";
  record.step_s = 1e-3;
  for (int i = 0; i < 2000; ++i) record.u.push_back(std::sin(0.05 * i));
  hysteresis::IdentifyOptions options;
  options.skip_s = 0.1;
  for (const double delay_s : {0.0, 0.4e-3, 3.7e-3, 7.6e-3}) {
    record.y = later_by(record.u, delay_s / record.step_s);
    EXPECT_NEAR(best_delay({&record, 1}, options, true), delay_s, 5e-5);
  }
}

TEST(StageFit, AnAdvancedRecordLosesItsEnd) {
  TimeRecord record;
  record.step_s = 0.5;
  record.u = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  record.y = {0.0, 10.0, 20.0, 30.0, 40.0, 50.0};
  const TimeRecord by = advanced(record, 0.75);
  EXPECT_EQ(by.u, (std::vector<double>{1.0, 2.0, 3.0, 4.0}));
  EXPECT_EQ(by.y, (std::vector<double>{15.0, 25.0, 35.0, 45.0}));
  EXPECT_EQ(advanced(record, 0.0).u, record.u);
  EXPECT_EQ(advanced(record, 9.0).u.size(), 2u);
}

/// A stage of two plays under a wave of changing size, late by `delay_s`; its first tenth drifts in from elsewhere.
TimeRecord disturbed_record(double drift, double delay_s) {
  TimeRecord out;
  out.file = "record";
  out.step_s = 1e-3;
  double narrow = 0.0;
  double wide = 0.0;
  std::vector<double> y;
  for (int i = 0; i < 4000; ++i) {
    const double u = std::sin(0.02 * i) * (1.0 + 0.5 * std::sin(0.0013 * i));
    narrow = std::clamp(narrow, u - 0.1, u + 0.1);
    wide = std::clamp(wide, u - 0.3, u + 0.3);
    out.u.push_back(u);
    y.push_back(narrow + wide + (i < 400 ? drift * (1.0 - i / 400.0) : 0.0) + 1e-3 * std::sin(11.0 * i * i));
  }
  out.y = later_by(y, delay_s / out.step_s);
  return out;
}

// A piezo whose records have the other sign: weights that are none below 0 made a straight line of it, 30 % off.
TEST(StageFit, OutputsThatFallAreFittedAsWellAsThoseThatRise) {
  const TimeRecord rising = disturbed_record(0.0, 0.0);
  TimeRecord falling = rising;
  for (double& y : falling.y) y = 5e-6 - 2e-6 * y;
  for (const char* name :
       {"prandtl_ishlinskii", "preisach", "krasnoselskii_pokrovskii", "exponential_operator"}) {
    const hysteresis::ModelType& type = hysteresis::model_type_registry().get(name);
    StageFitOptions options;
    options.identify.size = 10;
    const StageFit up = fit_stage(&type, {&rising, 1}, {}, options),
                   down = fit_stage(&type, {&falling, 1}, {}, options);
    EXPECT_LT(down.training.rms_percent, 1.05 * up.training.rms_percent + 1e-6) << name;
  }
}

TEST(RecordFindings, SayTransientsDelaysAndSingleFrequencies) {
  const TimeRecord clean = disturbed_record(0.0, 0.0);
  const RecordFindings nothing = find_in_records({&clean, 1}, {}, true);
  EXPECT_EQ(nothing.transient_s, 0.0);
  EXPECT_EQ(nothing.delay_s, 0.0);
  EXPECT_TRUE(nothing.notes.empty());
  // What comes back later is the model's error, not the start's.
  TimeRecord again = disturbed_record(3.0, 0.0);
  for (std::size_t i = 3000; i < 3400; ++i) again.y[i] += 3.0;
  EXPECT_EQ(find_in_records({&again, 1}, {}, false).transient_s, 0.0);
  EXPECT_FALSE(nothing.frequency_hz.has_value());
  const TimeRecord drifting = disturbed_record(3.0, 3.2e-3);
  const RecordFindings found = find_in_records({&drifting, 1}, {}, true);
  EXPECT_GT(found.transient_s, 0.2);
  EXPECT_LT(found.transient_s, 0.6);
  EXPECT_NEAR(found.delay_s, 3.2e-3, 5e-4);
  EXPECT_EQ(found.notes.size(), 2u);
  TimeRecord sine = clean;
  for (std::size_t i = 0; i < sine.size(); ++i)
    sine.u[i] = std::sin(0.01 * 3.14159265358979 * static_cast<double>(i));
  sine.y = sine.u;
  const RecordFindings single = find_in_records({&sine, 1}, {}, false);
  ASSERT_TRUE(single.frequency_hz.has_value());
  EXPECT_NEAR(*single.frequency_hz, 5.0, 0.05);
}

// What diagnose may refit: a delay beside a model whose own numbers stay leaves the size free all the same.
TEST(IdentifiedModel, LeavesTheSizeFreeWithADelay) {
  const TimeRecord record = disturbed_record(0.0, 3.2e-3);
  StageFit fit;
  fit.stage.delay_s = 3.2e-3;
  const chain::Chain model = identified_model(fit, {&record, 1}, 0.0);
  bool gain = false, delay = false;
  for (const chain::Block& block : model.blocks) {
    for (const chain::Parameter& p : block.parameters()) {
      gain = gain || (p.free && p.key() == "gain");
      delay = delay || (p.free && p.key() == "delay_s");
    }
  }
  EXPECT_TRUE(gain);
  EXPECT_TRUE(delay);
}

TEST(StageFit, AReportHasTheFitOrWhyThereIsNone) {
  StageFit fit;
  fit.model = "preisach";
  const Json made = to_json(fit);
  for (const char* key : {"training", "parameters", "notes", "compute_s"})
    EXPECT_TRUE(made.contains(key)) << key;
  EXPECT_FALSE(made.contains("refused"));
  fit.refused = "too short";
  EXPECT_EQ(to_json(fit), Json({{"model", "preisach"}, {"refused", "too short"}}));
}

TEST(ErrorFigures, AreThoseOfEquation8) {
  const ErrorFigures e = bodesmith::error_figures(std::vector{1.0, 2.0, 4.0}, std::vector{0.0, 2.0, 4.0});
  EXPECT_DOUBLE_EQ(e.rms, std::sqrt(1.0 / 3.0));
  EXPECT_DOUBLE_EQ(e.max, 1.0);
  EXPECT_DOUBLE_EQ(e.range, 4.0);
  EXPECT_DOUBLE_EQ(e.rms_percent, 25.0 * e.rms);
  EXPECT_NEAR(e.rms_free_offset, std::sqrt(2.0 / 9.0), 1e-15);
}

}  // namespace
}  // namespace bodesmith::identify
