// What acts in one training record alone is found, whichever of them is driven the furthest.
#include <gtest/gtest.h>

#include <string>

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

}  // namespace
}  // namespace bodesmith
