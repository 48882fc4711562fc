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
  r.holdout_rms = left + 0.02;
  r.log_evidence = -2.0;
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
  const std::string advice = gap::advice_for(refusing(gap::CandidateOutcome::not_judged, 0.5), study());
  EXPECT_NE(advice.find("explains for sure"), std::string::npos) << advice;
  EXPECT_NE(
      advice.find(
          "likeliest, at odds of 7.4 to 1 against: offset (after block 3), which would leave 0.5 rms of 1 and 0.52 of "
          "1 held out"),
      std::string::npos)
      << advice;
}

TEST(Advice, IsSilentOfEffectsThatTakeLittleOrFailOtherwise) {
  const std::string advice = gap::advice_for(refusing(gap::CandidateOutcome::takes_too_little, 0.5), study());
  EXPECT_NE(advice.find("no effect of the catalogue explains"), std::string::npos) << advice;
  EXPECT_EQ(advice.find("likeliest"), std::string::npos) << advice;
  gap::Diagnosis worse = refusing(gap::CandidateOutcome::not_judged, 0.5);
  worse.search.refused.front().holdout_rms = 1.1;
  EXPECT_EQ(gap::advice_for(worse, study()).find("likeliest"), std::string::npos);
}

TEST(Advice, TellsOfItWhereNothingIsSurelyMissing) {
  gap::Diagnosis d = refusing(gap::CandidateOutcome::not_judged, 0.5);
  d.verdict = gap::Verdict::nothing_missing;
  EXPECT_NE(gap::advice_for(d, study()).find("Nothing is surely missing; likeliest, at odds of 7.4"),
            std::string::npos);
  d.search.refused.front().log_evidence = -9.0;
  EXPECT_EQ(gap::advice_for(d, study()).find("likeliest"), std::string::npos);
}

}  // namespace
