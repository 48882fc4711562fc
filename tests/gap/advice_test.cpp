#include <gtest/gtest.h>

#include <cmath>

#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"

namespace {

using namespace bodesmith;

/// A search that named nothing and refused one effect for this, which would have left so much of 1.0.
gap::Diagnosis refusing(gap::CandidateOutcome outcome, double left) {
  gap::Diagnosis d;
  d.verdict = gap::Verdict::unexplained;
  d.final.train_rms = d.final.holdout_rms = 1.0;
  gap::Ranked r;
  r.effect = &gap::effect_registry().get("offset");
  r.placed = "after block 3";
  r.train_rms = left;
  r.folds_rms = left + 0.01;
  r.holdout_rms = left + 0.02;
  r.z = 2.24;
  r.train_z = 2.5;
  r.outcome = outcome;
  d.search.refused = {r};
  return d;
}

gap::Study study() {
  TimeRecord record;
  record.file = "made.csv";
  record.step_s = 1e-3;
  for (int k = 0; k < 200; ++k) record.u.push_back(std::sin(0.1 * k));
  record.y = record.u;
  return gap::Study::of({record}, {record}, {});
}

TEST(Advice, TellsOfAnEffectThatIsLikelyAndNotSure) {
  const std::string advice = gap::advice_for(refusing(gap::CandidateOutcome::not_significant, 0.5), study());
  EXPECT_NE(advice.find("explains for sure"), std::string::npos) << advice;
  EXPECT_NE(
      advice.find(
          "likeliest, by 2.2 standard deviations, too few for a name: offset (after block 3), which would "
          "leave 0.5 rms of 1 and 0.52 of 1 held out"),
      std::string::npos)
      << advice;
}

TEST(Advice, IsSilentOfEffectsThatTakeLittleOrFailOtherwise) {
  for (const gap::Diagnosis& d : {refusing(gap::CandidateOutcome::not_significant, 0.9),
                                  refusing(gap::CandidateOutcome::ill_conditioned, 0.5)}) {
    const std::string advice = gap::advice_for(d, study());
    EXPECT_NE(advice.find("no effect of the catalogue explains"), std::string::npos) << advice;
    EXPECT_EQ(advice.find("likeliest"), std::string::npos) << advice;
  }
  gap::Diagnosis worse = refusing(gap::CandidateOutcome::not_significant, 0.5);
  worse.search.refused.front().holdout_rms = 1.1;
  EXPECT_EQ(gap::advice_for(worse, study()).find("likeliest"), std::string::npos);
}

TEST(Advice, TellsOfItWhereNothingIsSurelyMissing) {
  gap::Diagnosis d = refusing(gap::CandidateOutcome::not_significant, 0.5);
  d.verdict = gap::Verdict::nothing_missing;
  EXPECT_EQ(gap::advice_for(d, study()).find("likeliest"), std::string::npos);
  d.search.refused.front().z = d.search.refused.front().train_z = 3.9;
  EXPECT_NE(gap::advice_for(d, study()).find("Nothing is surely missing; likeliest, by 3.9"),
            std::string::npos);
}

}  // namespace
