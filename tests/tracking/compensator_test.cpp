// What each kind of compensator is at one frequency.
#include "tracking/compensator.hpp"

#include <gtest/gtest.h>

namespace bodesmith::tracking {
namespace {

TEST(Compensator, AScheduledGainSettlesOnItsTable) {
  const ScheduledGain schedule{{Hertz{1.0}, Hertz{100.0}}, {1.0, 2.0}};
  const auto at = [&](double f) { return std::get<ConstantGain>(settled_at(schedule, Hertz{f})).gain; };
  EXPECT_DOUBLE_EQ(at(0.1), 1.0);
  EXPECT_DOUBLE_EQ(at(10.0), 1.5);
  EXPECT_DOUBLE_EQ(at(1e4), 2.0);
  EXPECT_DOUBLE_EQ(std::get<ConstantGain>(settled_at(ConstantGain{3.0}, Hertz{1.0})).gain, 3.0);
}

}  // namespace
}  // namespace bodesmith::tracking
