#include "tolerance/controller/trim.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "synthesis/controller/seed_controller.hpp"
#include "synthesis/generator/copy_numbers.hpp"

namespace bodesmith::tolerance {
namespace {

StudyOptions trim_study(std::vector<Hertz> frequencies) {
  StudyOptions out;
  out.frequencies = std::move(frequencies);
  return out;
}

TEST(Trim, ThreeBlindTrimsHalveTheErrorOrBetter) {
  const tracking::PolynomialStage stage(generator::seed_disturbance());
  TrimOptions options;
  options.draws = 300;
  const TrimStudy study =
      study_trims(generator::seed_controller(), stage, trim_study(generator::seed_frequencies()), options);
  EXPECT_EQ(study.steps.size(), 3u);
  EXPECT_LT(study.after.p95_percent, 0.5 * study.before.p95_percent);
  EXPECT_LT(study.after.median_percent, 0.10);
  EXPECT_LT(study.before.p95_percent, 0.5);
  for (std::size_t i = 1; i < study.foreseen_share.size(); ++i)
    EXPECT_LT(study.foreseen_share[i], study.foreseen_share[i - 1]);
  // What is foreseen is what comes out.
  EXPECT_NEAR(study.after.p95_percent / study.before.p95_percent, std::sqrt(study.foreseen_share.back()),
              0.15);
}

TEST(Trim, AVoltmeterWithMoreNoiseTrimsWorse) {
  const tracking::PolynomialStage stage(generator::seed_disturbance());
  TrimOptions options;
  options.draws = 100;
  const StudyOptions study = trim_study({Hertz{1.0}, Hertz{100.0}});
  const double fine = study_trims(generator::seed_controller(), stage, study, options).after.p95_percent;
  options.reading_noise_v = 5e-3;
  const double coarse = study_trims(generator::seed_controller(), stage, study, options).after.p95_percent;
  EXPECT_GT(coarse, 1.3 * fine);
}

TEST(Trim, TheReadingsOfTheDesignAreThoseOfTheStage) {
  // At rest v is the inverse of the stage: r = v + K d(v) with the slowest gain.
  const generator::DisturbanceCircuit& c = generator::seed_controller();
  const generator::RestWiring wiring(c);
  const Board board(wiring, copy_of(c, {}, {}));
  for (const double r : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    for (const bool rising : {true, false}) {
      const auto branch = rising ? Disturbance::Branch::ascending : Disturbance::Branch::descending;
      const double v = board.at_rest(r, rising);
      EXPECT_NEAR(v + c.disturbance.value(branch, v), r, 6e-4) << r;
    }
  }
  const Input input = input_of(tracking::Reference(), Hertz{100.0}, 256);
  EXPECT_NEAR(board.mean_slope_v(input) / (100.0 * c.slope->volts_per_hz), 1.0, 0.03);
}

TEST(Trim, OtherDisturbancesHaveTheirOwnTrims) {
  Disturbance d;
  d.ascending = {0.2, -0.2, 0.0};
  d.descending = {-0.1, 0.1, 0.0};
  generator::Options made(generator::Form::self_fed);
  made.tracked = {Hertz{5.0}, Hertz{50.0}};
  const generator::DisturbanceCircuit c = generator::make_controller(d, made);
  const tracking::PolynomialStage stage(d);
  TrimOptions options;
  options.draws = 150;
  const TrimStudy study = study_trims(c, stage, trim_study(made.tracked), options);
  EXPECT_GE(study.steps.size(), 2u);
  EXPECT_LT(study.after.p95_percent, 0.5 * study.before.p95_percent);
  for (const TrimStep& step : study.steps) EXPECT_NE(step.reading.words(c, made.tracked.back()), "");
}

TEST(Causes, TrimsMoveWhatTheyNameByTheirSetting) {
  const generator::DisturbanceCircuit& c = generator::seed_controller();
  for (const Trim& trim : trims_of(c)) {
    generator::Copy copy = copy_of(c, {}, {});
    trim.apply(copy, 0.01);
    double sum = 0.0, most = 0.0;
    for (const double v : numbers_of(copy)) sum += v, most = std::max(most, std::abs(v));
    EXPECT_EQ(sum, most) << trim.name;  // one number, upwards
    if (trim.name == "output offset") {
      // At the output: less at the op-amp's input by its noise gain.
      EXPECT_GT(most, 0.0);
      EXPECT_LT(most, 0.01);
    } else {
      EXPECT_EQ(most, 0.01) << trim.name;
    }
    EXPECT_NEAR(trim.unit_setting, 2.0 * trim.limit / 1000.0, 1e-15) << trim.name;
    EXPECT_EQ(trim.limit, trim.unit == "V" ? 0.03 : trim.name == "reference gain" ? 0.01 : 0.05) << trim.name;
  }
}

}  // namespace
}  // namespace bodesmith::tolerance
