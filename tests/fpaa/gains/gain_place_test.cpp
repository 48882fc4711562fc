// Places of a gain's capacitors as a user writes them.
#include "fpaa/gains/gain_schedule.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace bodesmith::fpaa {
namespace {

TEST(GainPlace, IsReadFromItsAddresses) {
  const GainPlace both = parse_gain_place("3:9.7/12.31", nullptr, "--x");
  EXPECT_EQ(both.address1, 3);
  ASSERT_EQ(both.over.size(), 1U);
  EXPECT_TRUE(both.over[0] == (MemoryPlace{9, 7}));
  ASSERT_EQ(both.under.size(), 1U);
  EXPECT_TRUE(both.under[0] == (MemoryPlace{12, 31}));
  EXPECT_EQ(both.words, "3:9.7/12.31");
  const GainPlace fixed = parse_gain_place("255:255.0/255", nullptr, "--x");
  EXPECT_EQ(fixed.address1, 255);
  EXPECT_EQ(fixed.fixed_under, 255);
  EXPECT_TRUE(fixed.under.empty());
  EXPECT_EQ(parse_gain_place("1:0.0/1", nullptr, "--x").fixed_under, 1);
}

TEST(GainPlace, RefusesWhatIsNone) {
  for (const char* wrong :
       {"0:3.7/3.6", "256:3.7/3.6", "1:256.7/3.6", "1:3.32/3.6", "1:3.7/3.32", "1:3.7/256.1", "1:3.7/0",
        "1:3.7/256", "1:3.7", "1/3.7:3.6", "1:3/3.6", "1:/3.6", "1:3.7/", "1:3.x/3.6", ":3.7/3.6", "1:3.7/-1",
        "99999999999:3.7/3.6", "chip.cam", ""})
    EXPECT_THROW(parse_gain_place(wrong, nullptr, "--x"), InputError) << wrong;
}

}  // namespace
}  // namespace bodesmith::fpaa
