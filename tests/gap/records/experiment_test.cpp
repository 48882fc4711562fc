// What acts in one training record alone is found, whichever of them is driven the furthest.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/made_record.hpp"

namespace bodesmith {
namespace {

TEST(EveryRecord, ARateThatIsLimitedInTheNarrowOneAloneIsNamed) {
  const std::string gain = "[[block]]\ntype = \"gain\"\ngain = 1.0\n";
  const std::string limited = "[[block]]\ntype = \"slew_limit\"\nrate_per_s = 90.0\n" + gain;
  // 30/s at most in the wide record, 177/s in the narrow one.
  const auto study =
      gap::Study::of({measured(limited, two_sines(500, 1.0, 2.0), 1e-3, 0.02, 1),
                      measured(limited, two_sines(500, 0.6, 20.0), 1e-3, 0.02, 2)},
                     {measured(limited, two_sines(500, 0.7, 15.0), 1e-3, 0.02, 3)}, model_of(gain));
  const auto d = gap::diagnose(model_of(gain), study, {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "slew_limit");
  EXPECT_EQ(d.verdict, gap::Verdict::explained);
}

TEST(TimeExperiment, ScoresWhatIsBehindTheStartAndWithinItsUse) {
  TimeRecord record;
  record.step_s = 1e-3;
  for (int i = 0; i < 100; ++i) {
    record.u.push_back(i);
    record.y.push_back(0.5 * i - 10.0);
  }
  gap::TimeExperiment one(record, 20);
  EXPECT_EQ(one.first(), 20U);
  EXPECT_EQ(one.scored(), 80U);
  EXPECT_TRUE(one.start_is_left_out());
  EXPECT_DOUBLE_EQ(one.range(), 49.5);
  EXPECT_EQ(one.scored_part(record.u).front(), 20.0);
  gap::TimeExperiment later = one;
  later.use(60, 90);
  EXPECT_EQ(later.first(), 60U);
  EXPECT_EQ(later.scored(), 30U);
  EXPECT_EQ(later.start(), 0U);
  EXPECT_EQ(later.scored_part(record.u).back(), 89.0);
  one.use(0, 50);
  EXPECT_EQ(one.first(), 20U);
  EXPECT_EQ(one.scored(), 30U);
  EXPECT_EQ(gap::scored_samples({one, later}), 60U);
  one.score_start();
  EXPECT_EQ(one.first(), 0U);
  EXPECT_EQ(one.start(), 20U);
  EXPECT_FALSE(one.start_is_left_out());
}

}  // namespace
}  // namespace bodesmith
