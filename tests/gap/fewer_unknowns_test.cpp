// Of two names that explain the records alike, the one with fewer unknowns, also where one record alone leaves the model's
// own values open and folds by records then favour the other one.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "gap/effect.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search/acceptance.hpp"
#include "made_model.hpp"
#include "signal/statistics.hpp"

namespace {

using namespace bodesmith;

/// A round of two candidates over two records, whose values matter to nothing but their names.
class TwoNames {
 public:
  TwoNames() : base_(model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\nfree = [\"gain\"]\n")) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 2; ++k) {
      TimeRecord r;
      r.file = "record.csv";
      r.step_s = 1e-3;
      for (int i = 0; i < 400; ++i) {
        r.u.push_back(normal(random));
        r.y.push_back(3.0 * normal(random));
      }
      train_.emplace_back(gap::TimeExperiment(r));
    }
    records_ = gap::make_records(train_, options_.stretches, base_);
    for (int i = 0; i < 800; ++i) left_.push_back(normal(random));
  }

  /// `left_on_folds`: times what the other one leaves there.
  gap::Ranked candidate(std::string_view name, std::size_t unknowns, double train_rms,
                        double left_on_folds) const {
    gap::Ranked r;
    r.effect = &gap::effect_registry().get(name);
    std::vector<gap::Proposal> proposals;
    r.effect->propose(gap::make_scene(base_, train_), proposals);
    r.model = proposals.front().model;
    r.placed = r.model.terms().back().placed;
    r.unknowns = r.effective = unknowns;
    r.train_rms = train_rms;
    for (double v : left_) r.folds.push_back(left_on_folds * v);
    r.folds_rms = rms(r.folds);
    r.z = r.train_z = 40.0;
    return r;
  }
  gap::Judgement judge(std::vector<gap::Ranked> ranking) const {
    const gap::SearchSetting setting{options_, base_, 3.0};
    return gap::judge(setting, records_, base_, std::move(ranking));
  }

 private:
  gap::SearchOptions options_;
  gap::Model base_;
  gap::Experiments train_;
  gap::SearchRecords records_;
  std::vector<double> left_;
};

TEST(FewerUnknowns, winWhenTheyComeFarNearerOnAllRecordsWhateverFoldsSay) {
  const TwoNames round;
  const auto judged =
      round.judge({round.candidate("resonance", 2, 1.0, 1.0), round.candidate("time_delay", 1, 0.8, 1.3)});
  ASSERT_TRUE(judged.step.has_value());
  EXPECT_EQ(judged.step->effect->name(), "time_delay");
}

TEST(FewerUnknowns, doNotWinByTheFoldsOfOneRecordAlone) {
  const TwoNames round;
  const auto judged =
      round.judge({round.candidate("resonance", 2, 1.0, 1.0), round.candidate("time_delay", 1, 0.95, 1.3)});
  ASSERT_TRUE(judged.step.has_value());
  EXPECT_EQ(judged.step->effect->name(), "resonance");
}

TEST(FourStandardDeviations, AreEnoughForAKnownSignalAlone) {
  const TwoNames round;
  for (const char* name : {"offset", "drift", "backlash", "time_delay"}) {
    auto candidate = round.candidate(name, 1, 0.5, 0.5);
    candidate.z = candidate.train_z = 4.5;
    const bool known = candidate.effect->adds_one_signal();
    EXPECT_EQ(round.judge({std::move(candidate)}).step.has_value(), known) << name;
  }
}

TEST(FewerUnknowns, winWhenTheyComeNearerOnAllRecords) {
  const TwoNames round;
  const auto judged = round.judge(
      {round.candidate("resonance", 2, 0.996, 1.0), round.candidate("time_delay", 1, 0.995, 1.03)});
  ASSERT_TRUE(judged.step.has_value());
  EXPECT_EQ(judged.step->effect->name(), "time_delay");
  EXPECT_TRUE(judged.step->tied_with.empty());
}

TEST(FewerUnknowns, loseWhenTheyLeaveMoreEverywhere) {
  const TwoNames round;
  const auto judged = round.judge(
      {round.candidate("resonance", 2, 0.996, 1.0), round.candidate("time_delay", 1, 1.026, 1.03)});
  ASSERT_TRUE(judged.step.has_value());
  EXPECT_EQ(judged.step->effect->name(), "resonance");
}

}  // namespace
