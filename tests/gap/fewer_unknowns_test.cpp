// Of two names that explain the records alike, the one with fewer unknowns, also where one record alone leaves the model's
// own values open and folds by records then favour the other one.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "base/document.hpp"
#include "chain/model_file.hpp"
#include "gap/effect.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search/acceptance.hpp"
#include "signal/statistics.hpp"

namespace {

using namespace bodesmith;

/// A round of two candidates over two records, whose values matter to nothing but their names.
class TwoNames {
 public:
  TwoNames()
      : base_(chain::model_from_node(parse_toml(
            "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 1.0\nfree = [\"gain\"]\n",
            "model.toml"))) {
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
