#include "base/whole_number.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace bodesmith {
namespace {

TEST(WholeNumber, HoldsWhatTheTypeCannot) {
  EXPECT_EQ(whole_number<int>(3.9), 3);
  EXPECT_EQ(whole_number<int>(-3.9), -3);
  EXPECT_EQ(whole_number<int>(1e300), std::numeric_limits<int>::max());
  EXPECT_EQ(whole_number<int>(-INFINITY), std::numeric_limits<int>::min());
  EXPECT_EQ(whole_number<std::size_t>(-0.5), 0U);
  EXPECT_EQ(whole_number<std::size_t>(18446744073709551616.0), std::numeric_limits<std::size_t>::max());
  EXPECT_EQ(whole_number<std::int64_t>(9223372036854775807.0), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(whole_number<int>(NAN, 2, 7), 2);
  EXPECT_EQ(whole_number<int>(9.0, 2, 7), 7);
}

TEST(WholeNumber, NearestGoesAwayFromZeroAndHoldsToo) {
  EXPECT_EQ(nearest_whole<int>(2.5), 3);
  EXPECT_EQ(nearest_whole<int>(-2.5), -3);
  EXPECT_EQ(nearest_whole<long>(1e300), std::numeric_limits<long>::max());
  EXPECT_EQ(nearest_whole<int>(NAN, 1, 255), 1);
  EXPECT_EQ(nearest_whole<int>(255.4, 1, 255), 255);
}

}  // namespace
}  // namespace bodesmith
