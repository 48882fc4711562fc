// What a name must show, and what an unknown costs.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "gap/effect.hpp"
#include "gap/evidence/score.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search/acceptance.hpp"
#include "made_model.hpp"
#include "signal/statistics.hpp"

namespace {

using namespace bodesmith;

/// A round over two records, in which the values of candidates matter to nothing but their names.
class Round {
 public:
  Round() : base_(model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\nfree = [\"gain\"]\n")) {
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

TEST(FourStandardDeviations, AreEnoughForAKnownSignalAlone) {
  const Round round;
  for (const char* name : {"offset", "drift", "backlash", "time_delay"}) {
    auto candidate = round.candidate(name, 1, 0.5, 0.5);
    candidate.z = candidate.train_z = 4.5;
    const bool known = candidate.effect->adds_one_signal();
    EXPECT_EQ(round.judge({std::move(candidate)}).step.has_value(), known) << name;
  }
}

/// What this chain leaves of a record is the same, whether its gain is free or not.
TEST(FewerUnknowns, costHalfTheLogarithmOfTheSamplesThatCount) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = 1e-3;
  for (int i = 0; i < 600; ++i) {
    r.u.push_back(normal(random));
    r.y.push_back(r.u.back() + 0.1 * normal(random));
  }
  const gap::Experiments train = {gap::TimeExperiment(r)};
  const std::string gain = "[[block]]\ntype = \"gain\"\ngain = 1.0\n";
  const gap::Model fixed(model_of(gain));
  const gap::Model free(model_of(gain + "free = [\"gain\"]\n"));
  const auto evidence = gap::log_evidences({&fixed, &free}, train);
  const double counted = 600.0 / (6.0 * correlation_time(gap::residuals_of(fixed, train)));
  EXPECT_NEAR(evidence[0] - evidence[1], 0.5 * std::log(counted), 1e-9);
}

}  // namespace
