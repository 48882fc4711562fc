// What acts in one training record alone is found, whichever of them is driven the furthest.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "gap/diagnosis.hpp"
#include "gap/made_record.hpp"

namespace bodesmith {
namespace {

std::vector<double> two_sines(double size, double hz) {
  std::vector<double> u;
  for (int i = 0; i < 500; ++i)
    u.push_back(size * (std::sin(2.0 * std::numbers::pi * hz * 1e-3 * i) +
                        0.5 * std::sin(2.0 * std::numbers::pi * 2.7 * hz * 1e-3 * i)));
  return u;
}

TEST(EveryRecord, aRateThatIsLimitedInTheNarrowOneAloneIsNamed) {
  const std::string gain = "[[block]]\ntype = \"gain\"\ngain = 1.0\n";
  const std::string limited = "[[block]]\ntype = \"slew_limit\"\nrate_per_s = 90.0\n" + gain;
  // 30/s at most in the wide record, 177/s in the narrow one.
  const auto study = gap::Study::of({measured(limited, two_sines(1.0, 2.0), 1e-3, 0.02, 1),
                                     measured(limited, two_sines(0.6, 20.0), 1e-3, 0.02, 2)},
                                    {measured(limited, two_sines(0.7, 15.0), 1e-3, 0.02, 3)}, model_of(gain));
  const auto d = gap::diagnose(model_of(gain), study, {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "slew_limit");
  EXPECT_EQ(d.verdict, gap::Verdict::explained);
}

}  // namespace
}  // namespace bodesmith
